//! Web Serial of the browser.

use js_sys::{Array, Object, Reflect};
use motorlink_messages::{PortRef, UsbId};
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;
use web_sys::{DomException, Serial, SerialPort, SerialPortFilter, SerialPortRequestOptions};

use crate::link::serial_ports::{PickTrouble, best_first};

/// Whether the browser has Web Serial, by feature detection.
pub(crate) fn is_supported() -> bool {
    serial().is_some()
}

/// The ports that were permitted before, the one used last first.
pub(crate) async fn permitted(last: Option<UsbId>) -> Result<Vec<PortRef>, PickTrouble> {
    let ports = ports(&serial().ok_or(PickTrouble::NoWebSerial)?).await?;
    let usb = ports.iter().map(usb_of).collect::<Vec<_>>();
    Ok(best_first(&usb, last))
}

/// Opens the browser's picker; if `filtered`, it shows only usual RS485 adapters. The browser refuses unless this
/// is called during an action of the user.
pub(crate) async fn pick(filtered: bool) -> Result<PortRef, PickTrouble> {
    let serial = serial().ok_or(PickTrouble::NoWebSerial)?;
    let options = SerialPortRequestOptions::new();
    if filtered {
        let filters = UsbId::USUAL_VENDORS.map(|vendor| {
            let filter = SerialPortFilter::new();
            filter.set_usb_vendor_id(vendor);
            filter
        });
        options.set_filters(&filters);
    }
    let picked: SerialPort = JsFuture::from(serial.request_port_with_options(&options))
        .await
        .map_err(|error| trouble(&error, filtered))?
        .unchecked_into();
    let ports = ports(&serial).await?;
    let place = ports
        .iter()
        .position(|port| Object::is(port, &picked))
        .and_then(|place| u16::try_from(place).ok())
        .ok_or(PickTrouble::Vanished)?;
    Ok(PortRef {
        place,
        usb: usb_of(&picked),
    })
}

fn serial() -> Option<Serial> {
    let navigator = web_sys::window()?.navigator();
    let serial = Reflect::get(&navigator, &JsValue::from_str("serial")).ok()?;
    serial.is_object().then(|| serial.unchecked_into())
}

async fn ports(serial: &Serial) -> Result<Vec<SerialPort>, PickTrouble> {
    let ports = JsFuture::from(serial.get_ports())
        .await
        .map_err(|error| trouble(&error, false))?;
    Ok(Array::from(&ports)
        .iter()
        .map(JsCast::unchecked_into)
        .collect())
}

fn usb_of(port: &SerialPort) -> Option<UsbId> {
    let info = port.get_info();
    Some(UsbId {
        vendor: info.get_usb_vendor_id()?,
        product: info.get_usb_product_id()?,
    })
}

fn trouble(error: &JsValue, filtered: bool) -> PickTrouble {
    let name = error.dyn_ref::<DomException>().map(DomException::name);
    match name.as_deref() {
        Some("NotFoundError" | "AbortError") => PickTrouble::Dismissed { filtered },
        Some("SecurityError" | "NotAllowedError") if is_framed() => PickTrouble::Framed,
        Some("SecurityError" | "NotAllowedError") => PickTrouble::Forbidden,
        _ => PickTrouble::Unknown,
    }
}

fn is_framed() -> bool {
    let window = web_sys::window();
    window.is_some_and(|window| window.parent().ok().flatten().as_ref() != Some(&window))
}
