// Which adapter is this tab's: see claim.rs of the worker.
const none = { release() {} };
let standing = Promise.resolve(none);

const makeOf = (port) => Object.values(port.getInfo()).join(":");

const lock = (name) => new Promise((give, fail) => {
  const kept = (lock) => (lock ? new Promise(give) : give(null));
  navigator.locks.request(name, { ifAvailable: true }, kept).catch(fail);
});

// Other tabs have some of these adapters, and nobody knows which: they are counted, while no other tab counts.
async function take(make, adapters) {
  const prefix = `adapter ${make} `;
  const { held } = await navigator.locks.query();
  const names = held.map(({ name }) => name).filter((name) => name.startsWith(prefix));
  if (names.length >= adapters) return null;
  let at = 0;
  while (names.includes(prefix + at)) at += 1;
  return lock(prefix + at);
}

async function claim(held, place) {
  const ports = place === undefined ? [] : await navigator.serial.getPorts();
  const make = place in ports && makeOf(ports[place]);
  if (make && make === held.make) return held;
  held.release();
  if (!make || !navigator.locks) return none;
  const adapters = ports.filter((port) => makeOf(port) === make).length;
  const release = await navigator.locks.request("adapters", () => take(make, adapters));
  return release && { make, release };
}

self.claimAdapter = async (place) => {
  const claimed = standing.then((held) => claim(held, place)).catch(() => none);
  standing = claimed.then((held) => held ?? none);
  return (await claimed) !== null;
};

