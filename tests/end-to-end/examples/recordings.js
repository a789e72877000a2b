// Measures a replay within the page: from the act of the user to the frame of the screen that shows its effect.

globalThis.recordings = (() => {
  const drawn = () =>
    new Promise((done) => requestAnimationFrame(() => {
      // After the frame was drawn, not before.
      const channel = new MessageChannel();
      channel.port1.onmessage = () => done(performance.now());
      channel.port2.postMessage(0);
    }));

  // Resolves when `is()` holds after a change of the page.
  const until = (is, what) =>
    new Promise((done, failed) => {
      if (is()) return done();
      const observer = new MutationObserver(() => {
        if (!is()) return;
        observer.disconnect();
        clearTimeout(limit);
        done();
      });
      const limit = setTimeout(() => {
        observer.disconnect();
        failed(new Error(`not within 10 s: ${what}`));
      }, 10_000);
      observer.observe(document, { subtree: true, childList: true, characterData: true, attributes: true });
    });

  const slider = () => document.querySelector(".replay-place");
  const go = (us) => {
    const field = slider();
    field.value = String(us);
    field.dispatchEvent(new Event("input", { bubbles: true }));
  };
  const speed = () => {
    const text = document.querySelector('[aria-label="Speed"]').textContent;
    const number = text.replace("\u2212", "-").match(/[+-]?\d+/);
    return number ? Number(number[0]) : NaN;
  };

  return {
    // Call it before a file is chosen. Resolves with the times from the choice to `Opened`, and to the drawn picture.
    watchOpening: () => {
      recordings.opening = (async () => {
        const began = await new Promise((done) =>
          document.addEventListener("change", () => done(performance.now()), { capture: true, once: true }));
        await until(() => document.querySelector(".session-content"), "the content");
        const opened = performance.now();
        await until(() => document.querySelector(".session-motor .session-speed")?.getAttribute("d"), "the picture");
        return { opened_ms: opened - began, pictured_ms: (await drawn()) - began };
      })();
      return true;
    },

    // The times from a jump to each of these places, in [microseconds, rpm], to the frame that shows its speed.
    jumps: async (places) => {
      const times = [];
      for (const [us, rpm] of places) {
        const began = performance.now();
        go(us);
        await until(() => Math.abs(speed() - rpm) <= 12, `${rpm} rpm at ${us} us`);
        times.push((await drawn()) - began);
        // All of the minute before it is read too.
        await new Promise((done) => setTimeout(done, 300));
      }
      return times;
    },

    // Drags the slider for these seconds, over the whole length. Returns frames of the screen a second, the longest
    // time between two of them, and the places a second that were shown.
    scrub: async (seconds) => {
      const length = Number(slider().max);
      const ends = performance.now() + seconds * 1_000;
      let [frames, longest, last, shown] = [0, 0, performance.now(), 0];
      const observer = new MutationObserver(() => { shown += 1; });
      observer.observe(document.querySelector('[aria-label="Speed"]'), { subtree: true, childList: true, characterData: true });
      while (performance.now() < ends) {
        go(Math.round(length * (1 - (ends - performance.now()) / (seconds * 1_000))));
        const now = await new Promise(requestAnimationFrame);
        longest = Math.max(longest, now - last);
        last = now;
        frames += 1;
      }
      observer.disconnect();
      return { frames: frames / seconds, longest_ms: longest, shown: shown / seconds };
    },

    // Frames of the screen a second while nothing is dragged: what the machine can.
    idle: async (seconds) => {
      const ends = performance.now() + seconds * 1_000;
      let frames = 0;
      while (performance.now() < ends) {
        await new Promise(requestAnimationFrame);
        frames += 1;
      }
      return frames / seconds;
    },
  };
})();
