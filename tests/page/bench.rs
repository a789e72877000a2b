//! A mounted page, the worker it talks to, and the controls by their names.

use std::{cell::RefCell, rc::Rc};

use js_sys::{Array, Promise, Uint8Array};
use leptos::mount::{UnmountHandle, mount_to};
use motorlink::App;
use motorlink_messages::{
    Adapter, Connection, Notice, ToPage, ToWorker, Update,
    bus::{Activity, Answer, Command, Counters, LinkQuality, MotorStatus, Sample},
    decode, encode,
    protocol::{
        Celsius, CoarsePosition, Current, Detail, Faults, Instant, Mode, MotorId, Reply, Rpm,
    },
};
use wasm_bindgen::{JsCast, JsValue, prelude::Closure};
use wasm_bindgen_futures::JsFuture;
use web_sys::{
    Blob, BlobPropertyBag, BroadcastChannel, Document, Element, Event, HtmlElement,
    HtmlInputElement, KeyboardEvent, KeyboardEventInit, MessageEvent, Url,
};

/// Passes on what it is received, and says what it is bidden: as the worker that owns the port, or as the
/// recorder.
const WORKER: &str = r"
    const bench = new BroadcastChannel('CHANNEL' + (self.name === 'worker' ? '' : '-' + self.name));
    const plain = (data) => data instanceof MessagePort ? 'line' : data;
    // The recorder's answer to whether there is anything to save: that nothing speaks against it.
    let kept = [0];
    self.onmessage = ({ data }) => {
        if (data instanceof MessagePort) {
            data.onmessage = (asked) => {
                if (asked.data === null) data.postMessage(new Uint8Array(kept));
            };
        }
        bench.postMessage(Array.isArray(data) ? data.map(plain) : plain(data));
    };
    bench.onmessage = (event) => {
        if (event.data === 'fail') throw new Error('as it was asked to');
        if (event.data.kept) kept = event.data.kept;
        if (event.data === 'live?' || event.data.kept) bench.postMessage('up');
        else if (event.data === 'all?') { if (self.name === 'worker') bench.postMessage('up'); }
        else self.postMessage(event.data);
    };
    // As the worker that owns the port does: the page takes it for dead once its lock is free.
    if (self.name === 'worker') navigator.locks.request('worker ORIGIN', () => new Promise(() => {}));
    bench.postMessage('up');
";

/// Number of looks, 20 ms apart, until a test no longer waits. A busy computer may not draw for seconds.
pub const LOOKS_MAX: usize = 1_000;

pub struct Bench {
    channel: BroadcastChannel,
    received: Rc<RefCell<Vec<ToWorker>>>,
    up: Rc<RefCell<bool>>,
    root: HtmlElement,
    programs: [Element; 3],
    _on_message: Closure<dyn FnMut(MessageEvent)>,
    _page: Box<dyn std::any::Any>,
}

impl Bench {
    /// Mounts the page; the name keeps the worker apart from those of other tests.
    pub async fn new(name: &str) -> Self {
        Self::after(name, || ()).await
    }

    /// The same, where something is done before there is more of the page than its start.
    pub async fn after(name: &str, early: impl FnOnce()) -> Self {
        let channel = BroadcastChannel::new(name).unwrap();
        let received = Rc::new(RefCell::new(Vec::new()));
        let up = Rc::new(RefCell::new(false));
        let on_message = Closure::<dyn FnMut(MessageEvent)>::new({
            let (received, up) = (received.clone(), up.clone());
            move |event: MessageEvent| match event.data().dyn_into::<Uint8Array>() {
                Ok(bytes) => received.borrow_mut().push(decode(&bytes.to_vec()).unwrap()),
                Err(_) => *up.borrow_mut() = true,
            }
        });
        channel.set_onmessage(Some(on_message.as_ref().unchecked_ref()));

        let origin = format!("{:.0}", performance().time_origin().floor());
        let script = WORKER.replace("CHANNEL", name).replace("ORIGIN", &origin);
        let kind = BlobPropertyBag::new();
        kind.set_type("text/javascript");
        let parts = Array::of1(&JsValue::from_str(&script));
        let blob = Blob::new_with_str_sequence_and_options(&parts, &kind).unwrap();
        // A test that failed has left its own, and must not take this one with it.
        let left = document().query_selector_all("meta[name^=motorlink-], .bench");
        let left = left.unwrap();
        for left in (0..left.length()).filter_map(|place| left.get(place)) {
            left.unchecked_into::<Element>().remove();
        }
        let url = Url::create_object_url_with_blob(&blob).unwrap();
        let programs = ["worker", "recorder", "sessions"].map(|program| {
            let meta = document().create_element("meta").unwrap();
            let name = format!("motorlink-{program}");
            meta.set_attribute("name", &name).unwrap();
            meta.set_attribute("content", &url).unwrap();
            document().head().unwrap().append_child(&meta).unwrap();
            meta
        });

        // The targets that another test has entered.
        let storage = web_sys::window().unwrap().local_storage().unwrap();
        storage.unwrap().remove_item("motorlink.targets").unwrap();
        let root: HtmlElement = document().create_element("div").unwrap().unchecked_into();
        root.set_class_name("bench");
        document().body().unwrap().append_child(&root).unwrap();
        let page: UnmountHandle<_> = mount_to(root.clone(), App);
        early();
        let bench = Self {
            channel,
            received,
            up,
            root,
            programs,
            _on_message: on_message,
            _page: Box::new(page),
        };
        bench
            .until("the worker to start", || *bench.up.borrow())
            .await;
        let complete = || {
            let whole = ".page:not(.incomplete):not(.partial)";
            bench.root.query_selector(whole).unwrap()
        };
        bench
            .until("all parts of the page", || complete().is_some())
            .await;
        bench
    }

    /// The same with a motor that reports this loop and 0 rpm.
    pub async fn with_motor(name: &str, mode: Mode) -> Self {
        let bench = Self::new(name).await;
        let time_origin_ms = performance().time_origin();
        bench.post(&ToPage::Hello { time_origin_ms });
        bench.report(motor(mode, Activity::Idle), false);
        bench
            .until("the page to be connected", || {
                bench.text("status", "Mode").contains("loop")
            })
            .await;
        bench.received().await;
        bench
    }

    /// Has the worker say this.
    pub fn post(&self, message: &ToPage) {
        let bytes = Uint8Array::from(encode(message).unwrap().as_slice());
        self.channel.post_message(&bytes).unwrap();
    }

    /// Has the worker throw an error that nobody catches. It lives on.
    pub fn fail(&self) {
        self.channel.post_message(&"fail".into()).unwrap();
    }

    /// Whether the worker is there.
    pub async fn is_up(&self) -> bool {
        self.up.replace(false);
        self.channel.post_message(&"live?".into()).unwrap();
        pause(200).await;
        *self.up.borrow()
    }

    pub fn report(&self, motor: MotorStatus, halted: bool) {
        self.report_on(Adapter::VIRTUAL, motor, halted);
    }

    pub fn report_on(&self, adapter: Adapter, motor: MotorStatus, halted: bool) {
        self.report_with(adapter, motor, halted, vec![]);
    }

    pub fn report_with(
        &self,
        adapter: Adapter,
        motor: MotorStatus,
        halted: bool,
        notices: Vec<Notice>,
    ) {
        self.post(&ToPage::Update(Update {
            now: now(),
            connection: Connection::Connected(adapter),
            halted,
            motors: vec![motor],
            job: None,
            raw: None,
            line: None,
            samples: vec![],
            notices,
        }));
    }

    /// What the worker has received since the last call, after all of it has arrived.
    ///
    /// On a loaded computer one long timer ends before the page has had a turn, so it waits for many
    /// turns, then for the worker to have passed on what it has.
    pub async fn received(&self) -> Vec<ToWorker> {
        for _ in 0..10 {
            pause(20).await;
        }
        self.up.replace(false);
        self.channel.post_message(&"all?".into()).unwrap();
        self.until("the worker to pass on what it has", || *self.up.borrow())
            .await;
        self.received.borrow_mut().drain(..).collect()
    }

    /// The commands among them, each given just now.
    pub async fn commands(&self) -> Vec<Command> {
        let now_ms = performance().now();
        let command = |message| match message {
            ToWorker::Command { command, given_ms } => {
                assert!(
                    (now_ms - given_ms).abs() < 5_000.0,
                    "{given_ms} at {now_ms}"
                );
                Some(command)
            }
            _ => None,
        };
        self.received()
            .await
            .into_iter()
            .filter_map(command)
            .collect()
    }

    /// Every element with this role and accessible name that one can reach.
    pub fn find_all(&self, role: &str, name: &str) -> Vec<HtmlElement> {
        let all = self.root.query_selector_all("*").unwrap();
        (0..all.length())
            .filter_map(|place| all.get(place)?.dyn_into::<HtmlElement>().ok())
            .filter(|element| role_of(element) == role && name_of(element) == name)
            .filter(|element| element.closest("[hidden], .closed").unwrap().is_none())
            .collect()
    }

    pub fn find(&self, role: &str, name: &str) -> HtmlElement {
        let mut found = self.find_all(role, name);
        assert_eq!(found.len(), 1, "{role} {name:?}");
        found.remove(0)
    }

    pub fn text(&self, role: &str, name: &str) -> String {
        text_of(&self.find(role, name))
    }

    pub fn click(&self, name: &str) {
        self.find("button", name).click();
    }

    /// Replaces what is in a field.
    pub fn enter(&self, name: &str, text: &str) -> HtmlInputElement {
        self.enter_into("spinbutton", name, text)
    }

    pub fn enter_into(&self, role: &str, name: &str, text: &str) -> HtmlInputElement {
        let field: HtmlInputElement = self.find(role, name).unchecked_into();
        field.set_value(text);
        field.dispatch_event(&Event::new("input").unwrap()).unwrap();
        field
    }

    /// Opens the place of a panel.
    pub async fn open(&self, panel: &str) {
        let place = match panel {
            "Drive together" => "Drive",
            "Recording" | "Session file" => "Record",
            "Experiments" => "Test",
            "ID Manager" | "Settings" => "Setup",
            "Link health" | "Raw Hex" => "Diagnose",
            _ => panic!("no place has the panel {panel:?}"),
        };
        self.click(place);
        if panel == "Drive together" {
            let is_offered = || self.find_all("radio", "Group").len() == 1;
            self.until("the choice", is_offered).await;
            self.find("radio", "Group").click();
        }
        let is_open = || !self.find_all("region", panel).is_empty();
        self.until("the panel", is_open).await;
    }

    pub async fn until(&self, what: &str, is: impl Fn() -> bool) {
        for _ in 0..LOOKS_MAX {
            if is() {
                return;
            }
            pause(20).await;
        }
        panic!("timed out waiting for {what}");
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        self.channel.close();
        for meta in &self.programs {
            meta.remove();
        }
    }
}

/// Its words, with one space between them.
pub fn text_of(element: &HtmlElement) -> String {
    let text = element.text_content().unwrap_or_default();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Presses a key where the focus is.
pub fn press(key: &str) {
    dispatch_key("keydown", key, false);
}

/// A key goes down, repeats or comes up where the focus is. Whether the focused control gets it.
pub fn dispatch_key(name: &str, key: &str, repeat: bool) -> bool {
    let init = KeyboardEventInit::new();
    init.set_key(key);
    init.set_repeat(repeat);
    init.set_bubbles(true);
    init.set_cancelable(true);
    let event = KeyboardEvent::new_with_keyboard_event_init_dict(name, &init).unwrap();
    let focused = document().active_element().unwrap();
    focused.dispatch_event(&event).unwrap()
}

pub fn motor(mode: Mode, activity: Activity) -> MotorStatus {
    let reply = Reply {
        id: MotorId::FIRST,
        mode,
        current: Some(Current::from_raw(0)),
        speed: Some(Rpm::new(0)),
        detail: Detail::Query {
            temperature: Celsius::new(30),
            position: CoarsePosition::from_raw(0),
        },
        faults: Faults::NONE,
    };
    // A report that stays fresh for as long as a test takes.
    let at = now() + std::time::Duration::from_secs(60);
    MotorStatus {
        waiting: None,
        id: MotorId::FIRST,
        activity,
        last: Some(Sample { at, reply }),
        speed: reply.speed.map(|speed| (at, speed)),
        current: reply.current.map(|current| (at, current)),
        position: None,
        temperature: None,
        turns: None,
        answer: Answer::Comes,
        may_turn: false,
        turns_unasked: false,
        link: LinkQuality::default(),
        counters: Counters::default(),
    }
}

pub async fn pause(millis: i32) {
    let promise = Promise::new(&mut |resolve, _| {
        let window = web_sys::window().unwrap();
        window
            .set_timeout_with_callback_and_timeout_and_arguments_0(&resolve, millis)
            .unwrap();
    });
    JsFuture::from(promise).await.unwrap();
}

pub fn document() -> Document {
    web_sys::window().unwrap().document().unwrap()
}

pub fn performance() -> web_sys::Performance {
    web_sys::window().unwrap().performance().unwrap()
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "milliseconds of a test"
)]
pub fn now() -> Instant {
    Instant::from_millis(performance().now() as u64)
}

/// The role of the elements that the page uses, as a screen reader has it.
fn role_of(element: &HtmlElement) -> String {
    if let Some(role) = element.get_attribute("role") {
        return role;
    }
    let kind = element.get_attribute("type").unwrap_or_default();
    match (element.tag_name().as_str(), kind.as_str()) {
        ("BUTTON", _) => "button",
        ("OUTPUT", _) => "status",
        ("SELECT", _) => "combobox",
        ("TEXTAREA", _) | ("INPUT", "text") => "textbox",
        ("SECTION", _) => "region",
        ("NAV", _) => "navigation",
        ("UL" | "OL", _) => "list",
        ("INPUT", "range") => "slider",
        ("INPUT", "checkbox") => "checkbox",
        ("INPUT", "radio") => "radio",
        ("INPUT", "search") => "searchbox",
        ("PROGRESS", _) => "progressbar",
        _ => "",
    }
    .to_owned()
}

fn name_of(element: &HtmlElement) -> String {
    if let Some(name) = element.get_attribute("aria-label") {
        return name;
    }
    let label = element.closest("label").unwrap();
    let text = label.map_or_else(|| element.text_content(), |label| label.text_content());
    text.unwrap_or_default().trim().to_owned()
}
