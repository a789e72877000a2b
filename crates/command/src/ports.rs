//! `motorlink ports`: the serial ports of this computer.

use motorlink_driver::{FoundPort, found_ports};
use serde_json::{Value, json};

use crate::{
    failure::Failure,
    output::{print, say},
};

/// Prints the ports.
pub fn run(as_json: bool) -> Result<(), Failure> {
    let ports = found_ports()?;
    if as_json {
        let ports: Vec<_> = ports.iter().map(to_json).collect();
        print(format_args!("{}", Value::from(ports)))?;
        return Ok(());
    }
    if ports.is_empty() {
        say(format_args!("no serial ports: plug the USB adapter in"));
    }
    for port in &ports {
        let usb = port.usb.as_ref().map(|usb| {
            let (vendor, product) = (usb.vendor_id, usb.product_id);
            let name = usb.product.as_deref().unwrap_or("USB adapter");
            let serial = usb
                .serial
                .as_deref()
                .map(|serial| format!(", serial number {serial}"));
            format!(
                "{name} ({vendor:04x}:{product:04x}{})",
                serial.unwrap_or_default()
            )
        });
        print(format_args!(
            "{}  {}",
            port.path,
            usb.as_deref().unwrap_or("not a USB adapter")
        ))?;
        if let Some(holder) = &port.holder {
            print(format_args!("    in use by {holder}: {}", holder.remedy()))?;
        }
    }
    Ok(())
}

fn to_json(port: &FoundPort) -> Value {
    let usb = port.usb.as_ref().map(|usb| {
        json!({
            "vendor_id": usb.vendor_id,
            "product_id": usb.product_id,
            "serial": usb.serial,
            "product": usb.product,
        })
    });
    let holder = port.holder.as_ref();
    let holder = holder.map(|holder| json!({ "name": holder.name, "process": holder.process }));
    json!({ "path": port.path, "usb": usb, "holder": holder })
}
