// Replaces the service worker with `cargo xtask run`, which stores no files for offline use. Removes the service
// worker of a release at the same address, which would serve that release.

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
