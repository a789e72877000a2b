//! `/motors/<id>/plot`: the numbers of a motor's telemetry for PlotJuggler.
//!
//! PlotJuggler's plugin for this protocol takes ROS 2 messages in CDR and protobuf, but no JSON
//! (`classifyChannel` in `data_stream_foxglove_bridge/foxglove_protocol.hpp` of
//! <https://github.com/PlotJuggler/pj-official-plugins>). So these messages repeat those of `/motors/<id>/telemetry`.

use nojson::RawJson;

/// The name of the schema.
pub(super) const NAME: &str = "motorlink/msg/Plot";

/// In the order of the schema. They are members of `/motors/<id>/telemetry`.
const FIELDS: [&str; 7] = [
    "speed_rpm",
    "current_a",
    "position_deg",
    "turns",
    "temperature_c",
    "setpoint",
    "fault_code",
];

/// A CDR of XCDR1 with the lowest byte first (DDS-XTypes 1.3, 7.6.3.1.2).
const HEADER: [u8; 4] = [0, 1, 0, 0];

/// The schema (`ros2msg`).
pub(super) fn schema() -> String {
    FIELDS.map(|field| format!("float64 {field}\n")).concat()
}

/// The message in CDR, from that of the telemetry. A number that the reply does not contain is not a number (NaN).
pub(super) fn message(telemetry: &str) -> Vec<u8> {
    let json = RawJson::parse(telemetry).ok();
    let mut bytes = HEADER.to_vec();
    for field in FIELDS {
        let member = json.as_ref().and_then(|json| {
            let member = json.value().to_member(field).ok()?.optional()?;
            member
                .as_float_str()
                .or_else(|_| member.as_integer_str())
                .ok()?
                .parse()
                .ok()
        });
        bytes.extend(member.unwrap_or(f64::NAN).to_le_bytes());
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_has_the_numbers_of_the_telemetry() {
        let telemetry = r#"{"mono_us":5000,"speed_rpm":-7,"current_a":0.175,"position_deg":66.96,"turns":0.5,"mode":"velocity","fault_code":8,"faults":["stall"]}"#;
        let bytes = message(telemetry);
        let (header, values) = bytes.split_at(4);
        assert_eq!(header, HEADER);
        let values: Vec<_> = values
            .chunks_exact(8)
            .map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap()))
            .collect();
        assert_eq!(values[..4], [-7.0, 0.175, 66.96, 0.5]);
        assert!(values[4].is_nan() && values[5].is_nan());
        assert_eq!(values[6..], [8.0]);
        assert!(schema().starts_with("float64 speed_rpm\nfloat64 current_a\n"));
    }
}
