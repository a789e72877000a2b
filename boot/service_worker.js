// Stores all files of one version, so that the page starts and drives without a network. `cargo xtask build`
// replaces the names in double braces.

// Files with a content hash in their name: a stored one is always right.
const hashed = {{hashed}};

// Name and hash of the other files. During an update, a host may serve some files of the old version and some of
// the new one. A page made of both would not start, so the hash is checked.
const named = {{named}};

// Other pages of this origin have caches too, as has this page at another path. The prefix tells them apart.
const ours = `motorlink ${registration.scope} `;
const cacheName = `${ours}{{version}}`;

const absolute = (file) => new URL(file, location).href;
const index = absolute("./");
const kept = new Set([...hashed, ...named.map(([file]) => file)].map(absolute));

async function keep() {
  const cache = await caches.open(cacheName);
  const requests = [
    ...hashed.map((file) => new Request(file)),
    ...named.map(([file, integrity]) => new Request(file, { cache: "no-cache", integrity })),
  ];
  // One after the other: nothing waits for them, and the page itself needs the connection. `addAll` requests all
  // files at once and reads none before the last response has begun; small hosts fail at that.
  for (const request of requests) await cache.add(request);
}

// Deletes the old files. No page uses them: a new version takes over while one tab is open, which then reloads, or
// while none is open.
async function takeOver() {
  const names = await caches.keys();
  const old = names.filter((name) => name.startsWith(ours) && name !== cacheName);
  await Promise.all(old.map((name) => caches.delete(name)));
  await clients.claim();
}

async function answer(href, request) {
  const cache = await caches.open(cacheName);
  // The browser may delete a cache. Then the file comes from the network.
  return (await cache.match(href, { ignoreVary: true })) ?? fetch(request);
}

// Takes the new version only if a single tab is open. Another tab may be driving a motor, may load a file of its
// own version later, and may write another format into the browser's storage.
async function take(asking) {
  const tabs = await clients.matchAll({ type: "window", includeUncontrolled: true });
  if (tabs.filter(({ url }) => url.startsWith(registration.scope)).length > 1) {
    asking.postMessage("others");
  } else {
    await skipWaiting();
  }
}

addEventListener("install", (event) => event.waitUntil(keep()));
addEventListener("activate", (event) => event.waitUntil(takeOver()));
addEventListener("message", (event) => event.waitUntil(take(event.source)));
addEventListener("fetch", (event) => {
  const { request } = event;
  const [address] = request.url.split(/[?#]/);
  const href = address === absolute("index.html") ? index : address;
  if (request.method === "GET" && kept.has(href)) event.respondWith(answer(href, request));
});
