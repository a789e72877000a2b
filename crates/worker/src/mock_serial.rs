//! Serial ports for tests: `navigator.serial` with virtual motors behind its ports.

use std::{
    cell::{Cell, RefCell},
    rc::Rc,
    time::Duration,
};

use gloo_timers::future::sleep;
use js_sys::{Array, Function, Object, Reflect, Uint8Array, eval};
use motorlink_bus::{Command, LeftDriven};
use motorlink_messages::{
    Connection, ModelChoice, Notice, PortRef, ToPage, ToWorker, Update, UsbId, decode,
};
use motorlink_protocol::{Instant, MotorId};
use motorlink_simulator::{World, WorldConfig};
use wasm_bindgen::{JsCast, JsValue, prelude::Closure};
use wasm_bindgen_futures::spawn_local;

use crate::{
    connecting::{adapter_plugged, pump},
    port_owner::Shared,
    port_state::PortState,
    scope::{Clock, global},
    start::{handle, new_owner},
};

/// A port as the browser has it. `refuses` has the names of the errors of the next tries to open it; with `hangs` no read
/// is ever cancelled.
const PORT: &str = "((info, write) => {
    const port = { info, refuses: [], hangs: false, opened: 0, readable: null, writable: null };
    port.getInfo = () => port.info;
    port.renew = () => {
        const cancel = () => (port.hangs ? new Promise(() => {}) : undefined);
        port.readable = new ReadableStream({ start(feed) { port.feed = feed; }, cancel });
        port.writable = new WritableStream({ write });
    };
    port.open = async ({ baudRate }) => {
        const refusal = port.refuses.shift();
        if (refusal) throw new DOMException('not now', refusal);
        if (port.readable) throw new DOMException('it is open', 'InvalidStateError');
        port.opened += 1;
        port.renew();
    };
    port.close = async () => {
        if (port.readable?.locked || port.writable?.locked) throw new TypeError('locked');
        port.readable = port.writable = null;
    };
    port.fail = (name, renewed_ms) => {
        const { feed } = port;
        port.readable = null;
        feed.error(new DOMException('failed', name));
        if (renewed_ms === undefined) port.writable = null;
        else setTimeout(port.renew, renewed_ms);
    };
    return port;
})";

/// Keeps what the worker posts from the runner of the tests.
const POSTED: &str = "(() => {
    if (self.posted) return self.posted.splice(0);
    const post = self.postMessage.bind(self);
    self.posted = [];
    self.postMessage = (message, ...more) => {
        if (message instanceof Uint8Array) self.posted.push(message);
        else post(message, ...more);
    };
    return [];
})()";

/// A frame of the host, and when it was written.
pub(crate) type Written = (Instant, Vec<u8>);

/// A port with motors behind it.
#[derive(Clone)]
pub(crate) struct MockPort {
    pub(crate) port: JsValue,
    pub(crate) world: Rc<RefCell<World>>,
    pub(crate) written: Rc<RefCell<Vec<Written>>>,
    /// Called with every frame of the host when it is written.
    pub(crate) on_frame: Rc<RefCell<Option<OnFrame>>>,
}

pub(crate) type OnFrame = Box<dyn FnMut(&[u8])>;

/// The worker, and the ports of its computer.
pub(crate) struct Bench {
    pub(crate) owner: Shared,
    clock: Clock,
    ports: Array,
    runs: Rc<Cell<bool>>,
    pub(crate) updates: RefCell<Vec<Update>>,
}

pub(crate) const CH340: Option<UsbId> = Some(UsbId {
    vendor: 0x1A86,
    product: 0x7523,
});

impl Bench {
    pub(crate) fn new() -> Self {
        eval(POSTED).unwrap();
        let ports = Array::new();
        let serial = Object::new();
        let all = ports.clone();
        let get = Closure::<dyn FnMut() -> JsValue>::new(move || {
            wasm_bindgen_futures::future_to_promise({
                let now = all.slice(0, all.length());
                async move { Ok(now.into()) }
            })
            .into()
        });
        set(&serial, "getPorts", get.as_ref());
        get.forget();
        let property = Object::new();
        set(&property, "value", &serial);
        set(&property, "configurable", &true.into());
        Object::define_property(&global().navigator().into(), &"serial".into(), &property);
        let clock = Clock::new();
        Self {
            owner: new_owner(&clock),
            clock,
            ports,
            runs: Rc::new(Cell::new(true)),
            updates: RefCell::default(),
        }
    }

    pub(crate) fn now(&self) -> Instant {
        self.clock.now()
    }

    /// A port that is not plugged yet, with these motors.
    pub(crate) fn port(&self, usb: Option<UsbId>, ids: &[u8]) -> MockPort {
        let ids = ids.iter().map(|id| MotorId::new(*id).unwrap());
        let world = Rc::new(RefCell::new(World::new(WorldConfig::of(
            ModelChoice::default().model,
            ids,
        ))));
        self.port_to(usb, world)
    }

    /// Another port to the same motors, as after a replug.
    pub(crate) fn port_to(&self, usb: Option<UsbId>, world: Rc<RefCell<World>>) -> MockPort {
        let written = Rc::<RefCell<Vec<Written>>>::default();
        let on_frame = Rc::<RefCell<Option<OnFrame>>>::default();
        let info = Object::new();
        if let Some(usb) = usb {
            set(&info, "usbVendorId", &usb.vendor.into());
            set(&info, "usbProductId", &usb.product.into());
        }
        let write = {
            let (world, written, clock) = (world.clone(), written.clone(), self.clock.clone());
            let on_frame = on_frame.clone();
            Closure::<dyn FnMut(Uint8Array)>::new(move |chunk: Uint8Array| {
                let now = clock.now();
                if let Some(on_frame) = &mut *on_frame.borrow_mut() {
                    on_frame(&chunk.to_vec());
                }
                world.borrow_mut().transmit(now, &chunk.to_vec());
                written.borrow_mut().push((now, chunk.to_vec()));
            })
        };
        let make: Function = eval(PORT).unwrap().unchecked_into();
        let port = make.call2(&JsValue::NULL, &info, write.as_ref()).unwrap();
        write.forget();
        let port = MockPort {
            port,
            world,
            written,
            on_frame,
        };
        let (feeding, clock, runs) = (port.clone(), self.clock.clone(), self.runs.clone());
        spawn_local(async move {
            while runs.get() {
                feeding.feed(clock.now());
                sleep(Duration::from_millis(1)).await;
            }
        });
        port
    }

    pub(crate) fn plug(&self, port: &MockPort) {
        self.ports.push(&port.port);
        adapter_plugged(&self.owner);
    }

    /// Takes the port away as an unplugged adapter. Its motors go on.
    pub(crate) fn unplug(&self, port: &MockPort) {
        let at = self.ports.index_of(&port.port, 0);
        self.ports.splice_many(u32::try_from(at).unwrap(), 1, &[]);
        port.fail("NetworkError", None);
    }

    pub(crate) fn send(&self, message: ToWorker) {
        handle(&self.owner, message);
    }

    pub(crate) fn command(&self, command: Command) {
        self.pong();
        let given_ms = self.now().since(Instant::ZERO).as_secs_f64() * 1000.0;
        self.send(ToWorker::Command { command, given_ms });
    }

    fn pong(&self) {
        let page_ms = self.now().since(Instant::ZERO).as_secs_f64() * 1000.0;
        self.send(ToWorker::Pong { page_ms });
    }

    /// Presses Connect: every port that is there is a candidate.
    pub(crate) fn connect(&self) {
        self.connect_left(&[]);
    }

    /// The same, where the page knows that a worker before this one has driven these motors.
    pub(crate) fn connect_left(&self, left: &[u8]) {
        let usb = |port: JsValue| crate::serial::usb_of(port.unchecked_ref());
        let candidates = (0..).zip(self.ports.iter());
        let candidates = candidates
            .map(|(place, port)| PortRef {
                place,
                usb: usb(port),
            })
            .collect();
        self.send(ToWorker::ConnectSerial {
            candidates,
            wanted: MotorId::FIRST,
            model: ModelChoice::default(),
            left: left
                .iter()
                .map(|id| LeftDriven {
                    id: MotorId::new(*id).unwrap(),
                    mode: None,
                })
                .collect(),
        });
    }

    /// Waits until the state of the port is so. Answers the pings of the worker meanwhile.
    pub(crate) async fn until(&self, what: &str, is_so: impl Fn(&Self) -> bool) {
        for _ in 0..2_000 {
            self.pong();
            pump(&self.owner);
            for message in eval(POSTED).unwrap().unchecked_into::<Array>() {
                let bytes = message.unchecked_into::<Uint8Array>().to_vec();
                if let Ok(ToPage::Update(update)) = decode(&bytes) {
                    self.updates.borrow_mut().push(update);
                }
            }
            if is_so(self) {
                return;
            }
            sleep(Duration::from_millis(5)).await;
        }
        panic!(
            "waited in vain for {what}: {:?}",
            self.updates.borrow().last()
        );
    }

    pub(crate) async fn pause(&self, time: Duration) {
        let until = self.now() + time;
        self.until("some time", |bench| bench.now() >= until).await;
    }

    pub(crate) async fn until_connected(&self) {
        let connected = |bench: &Self| matches!(bench.connection(), Connection::Connected(_));
        self.until("a connection", connected).await;
    }

    pub(crate) fn connection(&self) -> Connection {
        self.owner.borrow().port.connection()
    }

    /// All that the page was told.
    pub(crate) fn notices(&self) -> Vec<Notice> {
        let updates = self.updates.borrow();
        updates
            .iter()
            .flat_map(|update| update.notices.iter().cloned())
            .collect()
    }
}

/// As when the tab is killed: no frame is sent any more, and no port is closed.
impl Drop for Bench {
    fn drop(&mut self) {
        self.runs.set(false);
        let mut owner = self.owner.borrow_mut();
        owner.generation += 1;
        owner.port = PortState::Closed;
    }
}

impl MockPort {
    fn feed(&self, now: Instant) {
        let mut world = self.world.borrow_mut();
        world.advance(now);
        if Reflect::get(&self.port, &"readable".into())
            .unwrap()
            .is_null()
        {
            return;
        }
        while let Some(chunk) = world.receive(now) {
            let feed = Reflect::get(&self.port, &"feed".into()).unwrap();
            let bytes = Uint8Array::from(chunk.bytes.as_slice());
            // A stream that is being closed takes none.
            let _ = method(&feed, "enqueue").call1(&feed, &bytes);
        }
    }

    /// Ends its streams with an error. With a time it has others after it.
    pub(crate) fn fail(&self, name: &str, renewed_ms: Option<u32>) {
        let renewed = renewed_ms.map_or(JsValue::UNDEFINED, JsValue::from);
        method(&self.port, "fail")
            .call2(&self.port, &name.into(), &renewed)
            .unwrap();
    }

    /// The next tries to open it fail so.
    pub(crate) fn refuse(&self, name: &str, times: u32) {
        let names = Array::new();
        (0..times).for_each(|_| _ = names.push(&name.into()));
        set(&self.port, "refuses", &names);
    }

    pub(crate) fn hang(&self) {
        set(&self.port, "hangs", &true.into());
    }

    /// How often it was opened.
    pub(crate) fn opened(&self) -> Option<f64> {
        Reflect::get(&self.port, &"opened".into()).unwrap().as_f64()
    }

    pub(crate) fn speed(&self, id: u8) -> f32 {
        let world = self.world.borrow();
        world.motor(MotorId::new(id).unwrap()).unwrap().speed_rpm()
    }

    pub(crate) fn frames(&self) -> Vec<Vec<u8>> {
        self.written
            .borrow()
            .iter()
            .map(|(_, bytes)| bytes.clone())
            .collect()
    }
}

fn method(object: &JsValue, name: &str) -> Function {
    Reflect::get(object, &name.into()).unwrap().unchecked_into()
}

fn set(object: &JsValue, name: &str, value: &JsValue) {
    Reflect::set(object, &name.into(), value).unwrap();
}
