//! `motorlink ports`: the serial ports of this computer.

use std::time::Duration;

use motorlink_driver::{Answered, FoundPort, found_port, found_ports};
use serde_json::{Value, json};

use crate::{
    failure::Failure,
    output::{print, say},
};

/// Prints the port with this name, or all ports.
pub fn run(path: Option<&str>, as_json: bool) -> Result<(), Failure> {
    let ports = match path {
        Some(path) => vec![found_port(path)?],
        None => found_ports()?,
    };
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
        for motor in port.answered_last() {
            let model = motor.model.map(|model| format!(" ({model})"));
            let ago = motor.ago.map(|ago| format!(" {}", words_of(ago)));
            print(format_args!(
                "    motor {}{} answered{}",
                motor.id,
                model.unwrap_or_default(),
                ago.unwrap_or_default()
            ))?;
        }
    }
    Ok(())
}

/// How long ago something was, in its largest unit.
fn words_of(ago: Duration) -> String {
    match ago.as_secs() {
        seconds @ 0..120 => format!("{seconds} s ago"),
        seconds @ 120..7_200 => format!("{} min ago", seconds / 60),
        seconds @ 7_200..172_800 => format!("{} h ago", seconds / 3_600),
        seconds => format!("{} days ago", seconds / 86_400),
    }
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
    let answered = port.answered_last();
    let answered: Vec<_> = answered.iter().map(motor_to_json).collect();
    json!({ "path": port.path, "usb": usb, "holder": holder, "answered": answered })
}

fn motor_to_json(motor: &Answered) -> Value {
    json!({
        "id": motor.id.get(),
        "model": motor.model.map(|model| model.spec().key),
        "seconds_ago": motor.ago.map(|ago| ago.as_secs()),
    })
}
