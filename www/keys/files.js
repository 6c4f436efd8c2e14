/** Files that are opened, dropped and saved. */

/** Shows the browser's dialog for a file of these endings. @returns {Promise<File | null>} */
export function choose(accept) {
  const input = document.createElement('input');
  Object.assign(input, { type: 'file', accept });
  return new Promise((resolve) => {
    input.addEventListener('change', () => resolve(input.files[0] ?? null));
    input.addEventListener('cancel', () => resolve(null));
    input.click();
  });
}

/** A file's text; throws a sentence where it is none. */
export async function textOf(file) {
  try {
    return new TextDecoder('utf-8', { fatal: true }).decode(await file.arrayBuffer());
  } catch {
    throw new Error(`${file.name} is no text in UTF-8, or cannot be read.`);
  }
}

/** What lies at an address as a file. */
export async function fetched(address) {
  const response = await fetch(address).catch(() => null);
  if (!response?.ok) throw new Error(`${address} could not be fetched${response ? `: the server answers ${response.status}` : ''}.`);
  return new File([await response.blob()], address.split(/[?#]/)[0].split('/').at(-1));
}

/** Gives a text to the reader as a file. */
export function save(name, text) {
  const address = URL.createObjectURL(new Blob([text], { type: 'application/toml' }));
  const link = document.createElement('a');
  Object.assign(link, { href: address, download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

/**
 * Files that are dropped anywhere on the page; before the players see them, who would take them for motion capture.
 * @param {(file: File, target: Element) => void} take
 */
export function listenForDrops(take) {
  const holdsFiles = ({ dataTransfer }) => dataTransfer?.types.includes('Files');
  const over = (event) => {
    if (!holdsFiles(event)) return;
    event.preventDefault();
    event.stopPropagation();
    event.dataTransfer.dropEffect = 'copy';
  };
  document.addEventListener('dragenter', over, true);
  document.addEventListener('dragover', over, true);
  document.addEventListener('drop', (event) => {
    if (!holdsFiles(event)) return;
    event.preventDefault();
    event.stopPropagation();
    for (const file of event.dataTransfer.files) take(file, event.target);
  }, true);
}
