//! The messages of the protocol that a server without capabilities needs.

use axum::body::Bytes;
use motorlink_protocol::MotorId;
use motorlink_session::Channel;
use nojson::{DisplayJson, JsonFormatter, RawJson, RawJsonValue};

use super::plot;

/// The subprotocols, the one to choose first. Foxglove and PlotJuggler ask for the new one, older programs for the other;
/// they differ in name only.
pub(super) const SUBPROTOCOLS: [&str; 2] = ["foxglove.sdk.v1", "foxglove.websocket.v1"];

/// The opcode of a binary message with data.
const MESSAGE_DATA: u8 = 1;

/// The number of the first motor's channels, less its ID. Other channels have smaller numbers.
const TELEMETRY: u32 = 0x100;
const PLOT: u32 = 0x200;

/// A channel of this server.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Offered {
    /// A channel of a session file.
    Session(Channel),
    /// Numbers for PlotJuggler.
    Plot(MotorId),
}

impl Offered {
    /// The channels of a motor.
    pub(super) const fn of_motor(id: MotorId) -> [Self; 2] {
        [Self::Session(Channel::Telemetry(id)), Self::Plot(id)]
    }

    /// Its number on every connection.
    pub(super) fn number(self) -> u32 {
        match self {
            Self::Session(Channel::Wire) => 1,
            Self::Session(Channel::Events) => 2,
            Self::Session(Channel::Link) => 3,
            Self::Session(Channel::Odometry) => 4,
            Self::Session(Channel::CommandedMotion) => 5,
            Self::Session(Channel::Telemetry(id)) => TELEMETRY + u32::from(id.get()),
            Self::Plot(id) => PLOT + u32::from(id.get()),
        }
    }
}

impl DisplayJson for Offered {
    fn fmt(&self, f: &mut JsonFormatter<'_, '_>) -> std::fmt::Result {
        f.object(|f| {
            f.member("id", self.number())?;
            match self {
                Self::Session(channel) => {
                    let (name, schema) = channel.schema();
                    f.member("topic", &*channel.topic())?;
                    f.member("encoding", "json")?;
                    f.member("schemaName", name)?;
                    f.member("schema", schema)?;
                    f.member("schemaEncoding", "jsonschema")
                }
                Self::Plot(id) => {
                    f.member("topic", format!("/motors/{}/plot", id.get()))?;
                    f.member("encoding", "cdr")?;
                    f.member("schemaName", plot::NAME)?;
                    f.member("schema", plot::schema())?;
                    f.member("schemaEncoding", "ros2msg")
                }
            }
        })
    }
}

/// A message of a client.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Request {
    /// Subscriptions, each with the number of its channel.
    Subscribe(Vec<(u32, u32)>),
    /// Subscriptions to end.
    Unsubscribe(Vec<u32>),
    /// What this server does not do, such as to set a parameter.
    Other,
}

impl Request {
    /// `None` if it is no message of the protocol.
    pub(super) fn read(text: &str) -> Option<Self> {
        let json = RawJson::parse(text).ok()?;
        let message = json.value();
        let op = member(message, "op")?.to_unquoted_string_str().ok()?;
        match &*op {
            "subscribe" => {
                let subscriptions = member(message, "subscriptions")?.to_array().ok()?;
                let pairs = subscriptions.map(|one| {
                    let number = |name| integer(member(one, name)?);
                    Some((number("id")?, number("channelId")?))
                });
                pairs.collect::<Option<_>>().map(Self::Subscribe)
            }
            "unsubscribe" => {
                let ids = member(message, "subscriptionIds")?.to_array().ok()?;
                let ids = ids.map(integer).collect::<Option<_>>();
                ids.map(Self::Unsubscribe)
            }
            _ => Some(Self::Other),
        }
    }
}

fn member<'text, 'raw>(
    object: RawJsonValue<'text, 'raw>,
    name: &str,
) -> Option<RawJsonValue<'text, 'raw>> {
    object.to_member(name).ok()?.optional()
}

fn integer(value: RawJsonValue<'_, '_>) -> Option<u32> {
    value.as_integer_str().ok()?.parse().ok()
}

/// The first message of a connection. Another start of the server has another `session`.
pub(super) fn server_info(session: &str) -> String {
    let json = nojson::object(|f| {
        f.member("op", "serverInfo")?;
        f.member("name", concat!("MotorLink ", env!("CARGO_PKG_VERSION")))?;
        f.member("capabilities", nojson::array(|_| Ok(())))?;
        f.member("sessionId", session)
    });
    json.to_string()
}

/// Says that there are these channels.
pub(super) fn advertise(channels: &[Offered]) -> String {
    let json = nojson::object(|f| {
        f.member("op", "advertise")?;
        f.member("channels", nojson::array(|f| f.elements(channels)))
    });
    json.to_string()
}

/// What a client shows its user.
#[derive(Clone, Copy, Debug)]
pub(super) enum Level {
    Warning = 1,
    Error = 2,
}

/// A text for the user. It takes the place of an earlier one with this ID.
pub(super) fn status(level: Level, id: &str, text: &str) -> String {
    let json = nojson::object(|f| {
        f.member("op", "status")?;
        f.member("level", level as u8)?;
        f.member("id", id)?;
        f.member("message", text)
    });
    json.to_string()
}

/// A message of a channel.
///
/// | bytes | content |
/// |---|---|
/// | 0 | opcode |
/// | 1-4 | subscription, the lowest byte first |
/// | 5-12 | nanoseconds since 1970, the lowest byte first |
/// | 13.. | what the message says |
pub(super) fn message_data(subscription: u32, log_ns: u64, data: &[u8]) -> Bytes {
    let parts: [&[u8]; 4] = [
        &[MESSAGE_DATA],
        &subscription.to_le_bytes(),
        &log_ns.to_le_bytes(),
        data,
    ];
    parts.concat().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_are_read_and_garbage_is_not() {
        let subscribe = r#"{"op":"subscribe","subscriptions":[{"id":0,"channelId":257},{"id":7,"channelId":1}]}"#;
        let cases = [
            (subscribe, Some(Request::Subscribe(vec![(0, 257), (7, 1)]))),
            (
                r#"{"op":"unsubscribe","subscriptionIds":[7]}"#,
                Some(Request::Unsubscribe(vec![7])),
            ),
            (
                r#"{"op":"advertise","channels":[{"id":1,"topic":"/cmd_vel"}]}"#,
                Some(Request::Other),
            ),
            (
                r#"{"op":"setParameters","parameters":[]}"#,
                Some(Request::Other),
            ),
            ("", None),
            ("[]", None),
            (r#"{"op":7}"#, None),
            (r#"{"op":"subscribe"}"#, None),
            (r#"{"op":"subscribe","subscriptions":[{"id":-1}]}"#, None),
            (r#"{"op":"unsubscribe","subscriptionIds":[1.5]}"#, None),
        ];
        for (text, expected) in cases {
            assert_eq!(Request::read(text), expected, "{text}");
        }
        let deep = "[".repeat(16_000);
        assert_eq!(Request::read(&deep), None);
    }

    /// The bytes and texts of the specification.
    #[test]
    fn messages_have_the_form_of_the_specification() {
        let expected = [1, 9, 0, 0, 0, 8, 7, 6, 5, 4, 3, 2, 1, b'{', b'}'];
        assert_eq!(message_data(9, 0x0102_0304_0506_0708, b"{}"), &expected[..]);
        let info = server_info("1");
        assert!(
            info.starts_with(r#"{"op":"serverInfo","name":"MotorLink "#),
            "{info}"
        );
        assert!(info.contains(r#""capabilities":[],"#), "{info}");
        assert_eq!(
            status(Level::Warning, "lost", "a \"b\""),
            r#"{"op":"status","level":1,"id":"lost","message":"a \"b\""}"#
        );
        let channels = advertise(&Offered::of_motor(MotorId::FIRST));
        let start = r#"{"op":"advertise","channels":[{"id":257,"topic":"/motors/1/telemetry","encoding":"json","schemaName":"motorlink.Telemetry","schema":"{\n"#;
        assert!(channels.starts_with(start), "{channels}");
        let end = r#""schemaEncoding":"jsonschema"},{"id":513,"topic":"/motors/1/plot","encoding":"cdr","schemaName":"motorlink/msg/Plot","schema":"float64 speed_rpm\nfloat64 current_a\nfloat64 position_deg\nfloat64 turns\nfloat64 temperature_c\nfloat64 setpoint\nfloat64 fault_code\n","schemaEncoding":"ros2msg"}]}"#;
        assert!(channels.ends_with(end), "{channels}");
    }
}
