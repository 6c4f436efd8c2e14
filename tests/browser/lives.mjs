/** What a page has left running: devices, timers, display frames, observers, listeners, and the memory of WebAssembly. */

/** Runs in the page before anything else: keeps count of all that lives on by itself. Moments of opening a device are told. */
export function countLives() {
  const lives = { devices: new Set(), timers: new Set(), frames: new Set(), observers: new Set(), listeners: new Set(), memories: [] };
  window.lives = lives;
  window.moment = () => {};
  window.count = () => Object.fromEntries(['devices', 'timers', 'frames', 'observers', 'listeners'].map((what) => [what, lives[what].size]));

  const { requestAdapter } = GPU.prototype;
  GPU.prototype.requestAdapter = function (...values) {
    window.moment('adapter');
    return requestAdapter.apply(this, values);
  };
  const { requestDevice } = GPUAdapter.prototype;
  GPUAdapter.prototype.requestDevice = async function (...values) {
    window.moment('device');
    const device = await requestDevice.apply(this, values);
    lives.devices.add(device);
    device.lost.then(() => lives.devices.delete(device));
    window.moment('opened');
    return device;
  };

  // A timer or a frame that is over, or taken back, is none any more.
  const once = (set, take, drop) => {
    const [original, cancel] = [window[take], window[drop]];
    window[take] = (work, ...rest) => {
      const handle = original.call(window, (...values) => {
        set.delete(handle);
        work(...values);
      }, ...rest);
      set.add(handle);
      return handle;
    };
    window[drop] = (handle) => {
      set.delete(handle);
      cancel.call(window, handle);
    };
  };
  once(lives.timers, 'setTimeout', 'clearTimeout');
  once(lives.frames, 'requestAnimationFrame', 'cancelAnimationFrame');
  const { setInterval: begin, clearInterval: end } = window;
  window.setInterval = (...values) => {
    const handle = begin.apply(window, values);
    lives.timers.add(`interval ${handle}`);
    return handle;
  };
  window.clearInterval = (handle) => {
    lives.timers.delete(`interval ${handle}`);
    end.call(window, handle);
  };

  for (const name of ['IntersectionObserver', 'ResizeObserver']) {
    const { observe, disconnect } = window[name].prototype;
    window[name].prototype.observe = function (...values) {
      lives.observers.add(this);
      return observe.apply(this, values);
    };
    window[name].prototype.disconnect = function () {
      lives.observers.delete(this);
      return disconnect.call(this);
    };
  }

  // Listeners of what outlives an element. Ours all come with a signal.
  const { addEventListener } = EventTarget.prototype;
  EventTarget.prototype.addEventListener = function (type, listener, options) {
    if (this === window || this === document || this instanceof MediaQueryList) {
      const entry = { type, listener };
      lives.listeners.add(entry);
      addEventListener.call(options?.signal ?? new EventTarget(), 'abort', () => lives.listeners.delete(entry));
    }
    return addEventListener.call(this, type, listener, options);
  };

  for (const name of ['instantiate', 'instantiateStreaming']) {
    const original = WebAssembly[name];
    WebAssembly[name] = async (...values) => {
      const made = await original.apply(WebAssembly, values);
      const { memory } = (made.instance ?? made).exports;
      if (memory) lives.memories.push(memory);
      return made;
    };
  }
}

/** Waits until nothing is left that was not there before. */
export async function nothingLeft(player, alone, what) {
  await player.until(`nothing left behind: ${what}`, (_, before) => JSON.stringify(window.count()) === JSON.stringify(before), alone).catch(async (error) => {
    throw new Error(`${error.message}\nbefore: ${JSON.stringify(alone)}\nafter: ${JSON.stringify(await player.page.evaluate(() => window.count()))}`);
  });
}
