// What a page needs that is to work without a network and can be installed. The Rust code calls
// `keepOffline` when the page works, `takeNewVersion` and `installPage` when a person presses so, and hears
// of all that happens by one event: see installation.rs and new_version.rs. None of it may fail aloud: the
// page works without.

const tell = (detail) => dispatchEvent(new CustomEvent("installation", { detail }));

const HOUR_MS = 3_600_000;

let prompt;
let registration;
let controlled = false;
let looked = performance.now();

function announce() {
  // The first of all is waiting for a moment too, but replaces nothing.
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
  // The first of all takes a page over too, which has the same files.
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
  // The browser may have offered it before anybody listened.
  if (prompt) tell("installable");
  // Not while it is written: a change has to show at once.
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
  // It can be shown once; if the user declines, the browser offers it again.
  prompt?.prompt().catch(() => {});
  prompt = undefined;
  tell("not-installable");
};
