// Put into the page before its own scripts: lets the bench speak for the page's workers.
//
// Messages are played at their times (milliseconds of performance.now()), each in a task of its own,
// as real ones come.
{
  const hex = (bytes) => [...bytes].map((byte) => byte.toString(16).padStart(2, '0')).join('');
  const tap = {
    // The first message of the worker that owns the port.
    hello: null,
    // Whether that worker is kept from saying anything more.
    muted: false,
    // What was given and not played yet.
    waiting: 0,
  };
  globalThis.benchTap = tap;

  // By whom a message is taken: the page, as from its worker, or the recorder, as from that worker.
  const takers = {
    page: (bytes) => tap.worker.dispatchEvent(new MessageEvent('message', { data: bytes })),
    recorder: (bytes) => tap.line.postMessage(bytes, [bytes.buffer]),
  };

  const RealWorker = Worker;
  globalThis.Worker = class extends RealWorker {
    constructor(url, options) {
      super(url, options);
      this.isRecorder = options?.name === 'recorder';
      if (this.isRecorder) return;
      tap.worker = this;
      this.addEventListener('message', (event) => {
        if (!event.isTrusted) return;
        tap.hello ??= hex(event.data);
        if (tap.muted) event.stopImmediatePropagation();
      });
    }

    // The recorder gets a line of ours instead of that to the other worker, which leads into ours.
    postMessage(message, transfer) {
      if (!this.isRecorder || !(message instanceof MessagePort)) {
        super.postMessage(message, transfer);
        return;
      }
      const { port1, port2 } = new MessageChannel();
      tap.line = port1;
      message.onmessage = ({ data }) => port1.postMessage(data);
      port1.onmessage = ({ data }) => message.postMessage(data);
      super.postMessage(port2, [port2]);
    }
  };

  const queues = { page: [], recorder: [] };
  const play = (taker) => {
    const queue = queues[taker];
    const [due, text] = queue[0];
    const wait = due - performance.now();
    if (wait > 0) {
      setTimeout(play, wait, taker);
      return;
    }
    queue.shift();
    tap.waiting -= 1;
    takers[taker](Uint8Array.fromHex(text));
    if (queue.length) setTimeout(play, 0, taker);
  };
  // Gives messages, [[ms, hex], ..] in the order of time.
  tap.give = (taker, messages) => {
    const idle = !queues[taker].length;
    queues[taker].push(...messages);
    tap.waiting += messages.length;
    if (idle && messages.length) play(taker);
  };
}
