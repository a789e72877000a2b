// Stands where a page is not kept, as while it is written (`cargo xtask run`): ends a service worker that a
// release left at this address, which would go on serving that release.

async function leave() {
  const names = await caches.keys();
  const ours = names.filter((name) => name.startsWith(`motorlink ${registration.scope} `));
  await Promise.all(ours.map((name) => caches.delete(name)));
  await registration.unregister();
  const tabs = await clients.matchAll({ type: "window" });
  await Promise.all(tabs.map((tab) => tab.navigate(tab.url)));
}

addEventListener("install", () => skipWaiting());
addEventListener("activate", (event) => event.waitUntil(leave()));
