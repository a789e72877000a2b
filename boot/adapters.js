// The adapter that this tab uses, and what is driven on it: see claim.rs and driven_file.rs of the worker.
const none = { release() {} };
let standing = Promise.resolve(none);

const makeOf = (port) => Object.values(port.getInfo()).join(":");

// The worker holds this lock from its first port on. When the lock is free, the page knows that the worker has
// ended: see rescue.rs.
let alive;
const living = () => new Promise((held) => {
  const name = `worker ${Math.floor(performance.timeOrigin)}`;
  const kept = () => new Promise(held);
  navigator.locks?.request(name, { mode: "shared" }, kept).catch(held);
  if (!navigator.locks) held();
});

const lock = (name) => new Promise((give, fail) => {
  const kept = (lock) => (lock ? new Promise(give) : give(null));
  navigator.locks.request(name, { ifAvailable: true }, kept).catch(fail);
});

// Other tabs use some of these adapters. The browser does not say which, so they are counted. The caller holds a
// lock, so that only one tab counts at a time.
async function take(make, adapters) {
  const prefix = `adapter ${make} `;
  const { held } = await navigator.locks.query();
  const names = held.map(({ name }) => name).filter((name) => name.startsWith(prefix));
  if (names.length >= adapters) return null;
  let at = 0;
  while (names.includes(prefix + at)) at += 1;
  const release = await lock(prefix + at);
  return release && { release, others: names.length };
}

// Another tab holds its file open; that file belongs to another adapter.
async function openIfFree(dir, name) {
  try {
    const file = await dir.getFileHandle(name, { create: true });
    return await file.createSyncAccessHandle();
  } catch {
    return null;
  }
}

// A crashed tab keeps its file locked for a moment.
const BUSY_TRIES = 10;
const BUSY_PAUSE_MS = 40;

// Opens the file of what is driven on adapters with these USB ids: the file of this tab, and the files that ended
// tabs left behind. `living` is the number of other tabs that use such adapters.
async function openDrivenFile(make, living) {
  const root = await navigator.storage.getDirectory();
  const dir = await root.getDirectoryHandle("motorlink-driven", { create: true });
  const prefix = `${make.replaceAll(":", "-") || "port"}.`;
  const names = [];
  for await (const name of dir.keys()) if (name.startsWith(prefix)) names.push(name);
  let next = 0;
  while (names.includes(prefix + next)) next += 1;
  const files = [];
  let busy = names;
  for (let tries = 1; ; tries += 1) {
    const opened = await Promise.all(busy.map((name) => openIfFree(dir, name)));
    busy = busy.filter((_, at) => !opened[at]);
    files.push(...opened.filter(Boolean));
    if (busy.length <= living || tries === BUSY_TRIES) break;
    await new Promise((pause) => setTimeout(pause, BUSY_PAUSE_MS));
  }
  if (!files.length) files.push(await openIfFree(dir, prefix + next));
  const found = files.map((file) => {
    const bytes = new Uint8Array(file.getSize());
    file.read(bytes, { at: 0 });
    return bytes;
  });
  const [own, ...others] = files;
  return {
    found,
    // Synchronous, so that the data survives the end of the process.
    write(bytes) {
      if (own.write(bytes, { at: 0 }) < bytes.length) return false;
      // The own file now contains the data of the others.
      for (const file of others.splice(0)) {
        file.truncate(0);
        file.close();
      }
      return true;
    },
    close() {
      for (const file of [own, ...others]) file.close();
    },
  };
}

// The longest wait for the files. A stop waits for them too.
const OPENED_WITHIN_MS = 500;

function drivenFileOf(make, living) {
  const opened = openDrivenFile(make, living).catch(() => null);
  const late = new Promise((give) => setTimeout(give, OPENED_WITHIN_MS, null));
  return Promise.race([opened, late]).then((file) => {
    if (!file) opened.then((opened) => opened?.close());
    return file;
  });
}

async function claim(held, place) {
  const ports = place === undefined ? [] : await navigator.serial.getPorts();
  const make = place in ports ? makeOf(ports[place]) : undefined;
  if (make !== undefined && make === held.make) return held;
  held.release();
  if (make === undefined) return none;
  await (alive ??= living());
  let taken = { ...none, others: 0 };
  if (make && navigator.locks) {
    const adapters = ports.filter((port) => makeOf(port) === make).length;
    taken = await navigator.locks.request("adapters", () => take(make, adapters));
    if (!taken) return null;
  }
  const file = await drivenFileOf(make, taken.others);
  const release = () => {
    file?.close();
    taken.release();
  };
  return { make, release, file };
}

// Gives false if other tabs use all adapters with these USB ids. Else gives the file of what is driven, or null.
self.claimAdapter = async (place) => {
  const claimed = standing.then((held) => claim(held, place)).catch(() => none);
  standing = claimed.then((held) => held ?? none);
  return ((await claimed) ?? { file: false }).file;
};
