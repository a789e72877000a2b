// Offline use and installation of the page. The Rust code calls `keepOffline` when the page has started, and
// `takeNewVersion` and `installPage` when a person presses the buttons. It listens to the event `installation`:
// see installation.rs and new_version.rs. Errors are ignored, since the page works without these functions.

const tell = (detail) => dispatchEvent(new CustomEvent("installation", { detail }));

const HOUR_MS = 3_600_000;

let prompt;
let registration;
let controlled = false;
let looked = performance.now();

function announce() {
  // The first service worker also waits for a moment, but it replaces none.
  if (registration.waiting && registration.active) tell("new-version");
}

function watch(found) {
  found?.addEventListener("statechange", announce);
}

function look() {
  if (document.visibilityState !== "visible" || performance.now() - looked < HOUR_MS) return;
  looked = performance.now();
  registration.update().catch(() => {});
}

async function register() {
  registration = await navigator.serviceWorker.register("./{{service_worker}}", {
    scope: "./",
    updateViaCache: "none",
  });
  watch(registration.installing);
  registration.addEventListener("updatefound", () => watch(registration.installing));
  navigator.serviceWorker.addEventListener("message", ({ data }) => tell(data));
  // The first service worker also takes control of the page, which already has the same files.
  controlled = navigator.serviceWorker.controller !== null;
  navigator.serviceWorker.addEventListener("controllerchange", () => {
    if (controlled) tell("taken");
    controlled = true;
  });
  addEventListener("focus", look);
  document.addEventListener("visibilitychange", look);
  announce();
}

globalThis.keepOffline = () => {
  // The browser may have offered the installation before the Rust code listened.
  if (prompt) tell("installable");
  // Not with `cargo xtask run`: a change must show at once.
  if ("{{kept}}" === "yes" && navigator.serviceWorker) register().catch(() => {});
};

globalThis.takeNewVersion = () => {
  const { waiting } = registration;
  if (!waiting) return;
  controlled = true;
  waiting.postMessage("take");
};

addEventListener("beforeinstallprompt", (event) => {
  event.preventDefault();
  prompt = event;
  tell("installable");
});

addEventListener("appinstalled", () => {
  prompt = undefined;
  tell("installed");
});

globalThis.installPage = () => {
  // The prompt can be shown once. If the user declines, the browser sends a new one.
  prompt?.prompt().catch(() => {});
  prompt = undefined;
  tell("not-installable");
};
