//! The first screen: what the page is for, and the buttons to begin with. It is shown in Drive while no port is open.

use leptos::prelude::*;
use motorlink_i18n::tr;

use crate::{
    features::connect::{actions::Connect, view::ConnectButtons},
    link::serial_ports,
    model::guards::serial_blocked_by,
    ui::reactive::dynamic,
};

#[component]
pub(crate) fn FirstScreen(connect: Connect) -> impl IntoView {
    let page = connect.page;
    // Without Web Serial, the style sheet shows only the buttons of virtual motors.
    let class = if serial_ports::is_supported() {
        "first-screen"
    } else {
        "first-screen no-serial"
    };
    let words = move || {
        serial_blocked_by(page.worker.state.get()).unwrap_or_else(|| {
            tr!(
                "DDSM115, DDSM315, DDSM210, DDSM400 and M0601 on a USB adapter. Nothing to install."
            )
            .to_owned()
        })
    };
    view! {
        <section class=class hidden=dynamic(move || !page.shows_first_screen())>
            <h2>{tr!("Drive your hub motor from the browser")}</h2>
            <p>{dynamic(words)}</p>
            <ConnectButtons connect is_first=true />
        </section>
    }
}
