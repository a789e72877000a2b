// Keeps all files of one version, so that the page starts and drives without a network. `cargo xtask build`
// fills in what is in double braces.

// Their names change with what is in them: what is there under this name is right.
const hashed = {{hashed}};

// Name and content. A host may hand out this file of one version and those of another for a while; taken
// for one version they would make a page that does not start.
const named = {{named}};

// Other pages of this origin have caches too, and so has this page at another path.
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
  // One after the other: nothing waits for them, and a page in use has the line. `addAll`
  // would ask for all at once, and read none before the last has begun to come: small hosts stop at that.
  for (const request of requests) await cache.add(request);
}

// The old files are not needed: a version is taken while a single tab is open, which then reloads, or
// between two visits.
async function takeOver() {
  const names = await caches.keys();
  const old = names.filter((name) => name.startsWith(ours) && name !== cacheName);
  await Promise.all(old.map((name) => caches.delete(name)));
  await clients.claim();
}

async function answer(href, request) {
  const cache = await caches.open(cacheName);
  // A browser may throw a cache away: then it is as without one.
  return (await cache.match(href, { ignoreVary: true })) ?? fetch(request);
}

// Another tab may drive, or load a file of its own version later; and what the versions write into the
// browser's storage may differ. So there is one version at a time.
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
