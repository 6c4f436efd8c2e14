/** Bundles with a section more or less, for what the demo's actor does not have or always has (docs/bundle-format.md). */

const HEADER = 48;
const ENTRY = 40;

/** CRC-32 with the polynomial of zlib. */
function checksum(bytes) {
  let sum = -1;
  for (const byte of bytes) {
    sum ^= byte;
    for (let bit = 0; bit < 8; bit += 1) sum = (sum >>> 1) ^ (sum & 1 ? 0xedb88320 : 0);
  }
  return (sum ^ -1) >>> 0;
}

/**
 * @param {Buffer} bundle
 * @param {{kind: number, minor: number, raw: Buffer}} section an optional one, and the minor version that knows it
 */
export function withSection(bundle, { kind, minor, raw }) {
  const count = bundle.readUInt32LE(16);
  const table = HEADER + ENTRY * count;
  const head = Buffer.alloc(table + ENTRY);
  bundle.copy(head, 0, 0, table);
  for (let at = HEADER; at < table; at += ENTRY) head.writeBigUInt64LE(head.readBigUInt64LE(at + 8) + BigInt(ENTRY), at + 8);
  head.writeUInt16LE(kind, table);
  head.writeUInt8(1, table + 2);
  head.writeBigUInt64LE(BigInt(bundle.length + ENTRY), table + 8);
  head.writeBigUInt64LE(BigInt(raw.length), table + 16);
  head.writeBigUInt64LE(BigInt(raw.length), table + 24);
  head.writeUInt32LE(checksum(raw), table + 32);
  head.writeUInt16LE(Math.max(minor, head.readUInt16LE(10)), 10);
  head.writeUInt32LE(head.length, 12);
  head.writeUInt32LE(count + 1, 16);
  head.writeBigUInt64LE(BigInt(bundle.length + ENTRY + raw.length), 20);
  head.writeUInt32LE(0, 28);
  head.writeUInt32LE(checksum(head), 28);
  return Buffer.concat([head, bundle.subarray(table), raw]);
}

/** A kind that no version knows. */
const NOBODYS = 0xfff0;

/**
 * The bundle as one reads it that does not know the kind, which has to be an optional one.
 * @param {Buffer} bundle
 * @param {number} kind
 */
export function withoutSection(bundle, kind) {
  const changed = Buffer.from(bundle);
  const end = HEADER + ENTRY * changed.readUInt32LE(16);
  for (let at = HEADER; at < end; at += ENTRY) if (changed.readUInt16LE(at) === kind) changed.writeUInt16LE(NOBODYS, at);
  changed.writeUInt32LE(0, 28);
  changed.writeUInt32LE(checksum(changed.subarray(0, changed.readUInt32LE(12))), 28);
  return changed;
}
