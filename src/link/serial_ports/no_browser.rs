//! Outside a browser there is no Web Serial, as in some browsers.

use motorlink_messages::{PortRef, UsbId};

use crate::link::serial_ports::PickTrouble;

pub(crate) fn is_supported() -> bool {
    false
}

pub(crate) async fn permitted(_last: Option<UsbId>) -> Result<Vec<PortRef>, PickTrouble> {
    std::future::ready(Err(PickTrouble::NoWebSerial)).await
}

pub(crate) async fn pick(_filtered: bool) -> Result<PortRef, PickTrouble> {
    std::future::ready(Err(PickTrouble::NoWebSerial)).await
}
