//! Group `Remote` in the header: who drives, and the buttons that change it.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::remote::{RemoteRequest, WhoDrives};
use wasm_bindgen::{JsCast, prelude::Closure};
use web_sys::{HtmlButtonElement, MessageChannel, MessageEvent, MessagePort};

use crate::{
    features::remote::texts,
    model::page::Page,
    ui::reactive::{dynamic, handler, memo},
};

/// The button for what can be asked for now.
fn button(control: WhoDrives) -> String {
    let (request, label, class) = match control {
        WhoDrives::Off => (RemoteRequest::Watch, tr!("Watch"), ""),
        WhoDrives::Connecting | WhoDrives::OtherVersion => return String::new(),
        WhoDrives::Mine | WhoDrives::MineAndAsked => {
            (RemoteRequest::GiveUp, tr!("Give up control"), "")
        }
        WhoDrives::Free | WhoDrives::Others => {
            (RemoteRequest::Ask, tr!("Take control"), " primary")
        }
        // The first press asks the operator, the second one takes control.
        WhoDrives::OthersAndAsked => (
            RemoteRequest::TakeByForce,
            tr!("Take control now"),
            " primary",
        ),
    };
    let value = request.text();
    format!(r#"<button type="button" class="button{class}" value="{value}">{label}</button>"#)
}

/// Links to the sessions that the server has written and to the robots that it shows, and what the browser does not allow at
/// this address. The style shows each where the server says so.
fn of_server() -> String {
    [
        "<div class=of-server><a href=sessions target=_blank>",
        tr!("Sessions"),
        "</a><a href=fleet target=_blank>",
        tr!("Fleet"),
        "</a><details><summary>",
        tr!("Not encrypted"),
        "</summary><p>",
        texts::without_encryption(),
        "</p></details></div>",
    ]
    .concat()
}

/// Group `Remote`: status `Operator`, buttons `Watch`, `Take control`, `Give up control`, links `Sessions` and `Fleet`.
#[component]
pub(crate) fn RemoteGroup(page: Page) -> impl IntoView {
    let state = RwSignal::new(String::new());
    let port = StoredValue::new_local(worker_port(page, move |text| state.set(text)));
    let press = move |event: web_sys::MouseEvent| {
        let button = event.target().and_then(|at| at.dyn_into().ok());
        if let Some(button) = button.map(|button: HtmlButtonElement| button.value()) {
            port.with_value(|port| port.as_ref().map(|port| port.post_message(&button.into())));
        }
    };
    let with = move |take: fn(WhoDrives, &str) -> String| {
        state.with(|text| {
            let (control, viewer) = WhoDrives::of(text).unwrap_or((WhoDrives::Connecting, ""));
            take(control, viewer)
        })
    };
    // A button that stays keeps the focus.
    let shown = memo(move || with(|control, _| button(control) + &of_server()));
    view! {
        <div class="remote" role="group" aria-label=tr!("Remote")>
            <span
                on:click=handler(press)
                inner_html=dynamic(move || shown.get())
            ></span>
            <span class="operator" role="status" aria-label=tr!("Operator")>
                {dynamic(move || with(texts::of_control))}
            </span>
        </div>
    }
}

/// A port to the worker that connects this page to the server. `receive` gets its messages for as long as the page is
/// shown.
fn worker_port(page: Page, receive: impl Fn(String) + 'static) -> Option<MessagePort> {
    let channel = MessageChannel::new().ok()?;
    let own = channel.port1();
    let on_message = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
        receive(event.data().as_string().unwrap_or_default());
    });
    own.set_onmessage(Some(on_message.as_ref().unchecked_ref()));
    on_message.forget();
    page.worker.link.with_value(|link| {
        if let Some(link) = link {
            link.hand_over_group(&channel.port2());
        }
    });
    Some(own)
}
