//! Clients of Foxglove's WebSocket protocol, on a real server with a virtual motor.
#![cfg(test)]

mod support;

use std::{
    collections::{BTreeMap, BTreeSet},
    env,
    net::TcpStream,
    process::Command,
    sync::{Arc, Mutex},
    time::{Duration, Instant},
};

use motorlink_bus::Event;
use motorlink_driver::{Entry, words};
use motorlink_remote_server::Token;
use motorlink_session::Writer;
use nojson::RawJson;
use tungstenite::{
    Message, WebSocket, client::IntoClientRequest, http::HeaderValue, stream::MaybeTlsStream,
};

use support::{Bench, SOON};

const BOTH: &str = "foxglove.websocket.v1, foxglove.sdk.v1";
/// The channel of the first motor.
const TELEMETRY: u32 = 257;

type Refused = Box<tungstenite::Error>;

/// A client of the protocol.
struct Client {
    socket: WebSocket<MaybeTlsStream<TcpStream>>,
    protocol: String,
    texts: Vec<String>,
    /// Subscription, nanoseconds and JSON.
    messages: Vec<(u32, u64, String)>,
}

/// Opens `/foxglove` with this query and these headers.
fn connect(bench: &Bench, query: &str, headers: &[(&str, &str)]) -> Result<Client, Refused> {
    connect_at(bench, &format!("/foxglove{query}"), headers)
}

fn connect_at(bench: &Bench, path: &str, headers: &[(&str, &str)]) -> Result<Client, Refused> {
    let url = format!("ws://{}{path}", bench.address);
    let mut request = url.into_client_request()?;
    for (name, value) in headers {
        let name = tungstenite::http::HeaderName::try_from(*name).unwrap();
        let value = HeaderValue::try_from(*value).unwrap();
        request.headers_mut().insert(name, value);
    }
    let (socket, answer) = tungstenite::connect(request)?;
    let protocol = &answer.headers()["Sec-WebSocket-Protocol"];
    if let MaybeTlsStream::Plain(stream) = socket.get_ref() {
        stream
            .set_read_timeout(Some(Duration::from_millis(50)))
            .unwrap();
    }
    Ok(Client {
        socket,
        protocol: protocol.to_str().unwrap().to_owned(),
        texts: Vec::new(),
        messages: Vec::new(),
    })
}

fn client(bench: &Bench) -> Client {
    connect(bench, "", &[("Sec-WebSocket-Protocol", BOTH)]).unwrap()
}

/// The status of the answer to a client that is refused; 101 if it is not.
fn status(bench: &Bench, query: &str, headers: &[(&str, &str)]) -> u16 {
    let with_protocol = [headers, &[("Sec-WebSocket-Protocol", BOTH)]].concat();
    match connect(bench, query, &with_protocol).map_err(|error| *error) {
        Ok(_) => 101,
        Err(tungstenite::Error::Http(answer)) => answer.status().as_u16(),
        Err(error) => panic!("{error}"),
    }
}

impl Client {
    fn say(&mut self, text: &str) {
        self.socket.send(Message::text(text)).unwrap();
    }

    fn subscribe(&mut self, id: u32, channel: u32) {
        self.say(&format!(
            r#"{{"op":"subscribe","subscriptions":[{{"id":{id},"channelId":{channel}}}]}}"#
        ));
    }

    /// Takes what comes. Returns false once the server has closed.
    fn receive(&mut self) -> bool {
        match self.socket.read() {
            Ok(Message::Text(text)) => self.texts.push(text.to_string()),
            Ok(Message::Binary(bytes)) => {
                let (head, json) = bytes.split_at(13);
                assert_eq!(head[0], 1);
                let subscription = u32::from_le_bytes(head[1..5].try_into().unwrap());
                let ns = u64::from_le_bytes(head[5..].try_into().unwrap());
                let json = String::from_utf8(json.to_vec()).unwrap();
                self.messages.push((subscription, ns, json));
            }
            Ok(Message::Close(_)) | Err(tungstenite::Error::ConnectionClosed) => return false,
            Ok(_) => {}
            Err(tungstenite::Error::Io(error)) => {
                return matches!(
                    error.kind(),
                    std::io::ErrorKind::WouldBlock | std::io::ErrorKind::TimedOut
                );
            }
            Err(_) => return false,
        }
        true
    }

    fn wait(&mut self, what: &str, mut is_so: impl FnMut(&Self) -> bool) {
        let until = Instant::now() + SOON;
        while !is_so(self) {
            assert!(
                Instant::now() < until,
                "waited for {what}: {:?}",
                self.texts
            );
            assert!(self.receive(), "closed while waiting for {what}");
        }
    }

    fn closes(&mut self) -> bool {
        let until = Instant::now() + SOON;
        while Instant::now() < until {
            if !self.receive() {
                return true;
            }
        }
        false
    }

    fn has_text(&self, part: &str) -> bool {
        self.texts.iter().any(|text| text.contains(part))
    }

    /// The IDs and topics of the channels that it was told of.
    fn channels(&self) -> BTreeMap<u32, String> {
        let mut channels = BTreeMap::new();
        for text in &self.texts {
            let json = RawJson::parse(text).unwrap();
            let Some(advertised) = json.value().to_member("channels").unwrap().optional() else {
                continue;
            };
            for channel in advertised.to_array().unwrap() {
                let text = |name| {
                    let member = channel.to_member(name).unwrap().required().unwrap();
                    member.to_unquoted_string_str().unwrap().into_owned()
                };
                let (encoding, schema) = (text("encoding"), text("schema"));
                match text("schemaEncoding").as_str() {
                    "jsonschema" => assert!(encoding == "json" && RawJson::parse(&schema).is_ok()),
                    other => assert_eq!((encoding.as_str(), other), ("cdr", "ros2msg")),
                }
                let id = channel.to_member("id").unwrap().required().unwrap();
                channels.insert(id.as_raw_str().parse().unwrap(), text("topic"));
            }
        }
        channels
    }
}

#[test]
fn a_client_sees_the_channels_and_gets_the_messages_of_a_session_file() {
    let entries = Arc::new(Mutex::new(Vec::new()));
    let taken = Arc::clone(&entries);
    let bench = Bench::start_with(None, move |at, entry| {
        taken.lock().unwrap().push((at, entry.clone()));
    });
    let mut client = client(&bench);
    assert_eq!(client.protocol, "foxglove.sdk.v1");
    client.wait("the channel of the motor", |client| {
        client.channels().contains_key(&TELEMETRY)
    });
    let info = &client.texts[0];
    assert!(info.starts_with(r#"{"op":"serverInfo""#) && info.contains(r#""capabilities":[]"#));
    let channels = client.channels();
    let topics: Vec<_> = channels.values().map(String::as_str).collect();
    let expected = [
        "/wire",
        "/events",
        "/link",
        "/motors/1/telemetry",
        "/motors/1/plot",
    ];
    assert_eq!(topics, expected);
    let before = unix_ns();
    for (id, channel) in [(10, 1), (30, 3), (0, TELEMETRY)] {
        client.subscribe(id, channel);
    }
    client.wait("a second of the line", |client| {
        client.messages.iter().any(|(id, ..)| *id == 30)
    });
    client.say(r#"{"op":"unsubscribe","subscriptionIds":[0,10,30]}"#);
    let mut newest = Instant::now();
    let mut count = client.messages.len();
    while newest.elapsed() < Duration::from_millis(500) {
        assert!(client.receive());
        if client.messages.len() > count {
            (newest, count) = (Instant::now(), client.messages.len());
        }
    }

    // The file of the same entries.
    let mut writer = Writer::new(0, &[]);
    for (at, entry) in entries.lock().unwrap().iter() {
        match entry {
            Entry::Event(Event::Line(event)) => writer.line(event),
            entry => {
                if let Some(event) = words::session_event(entry) {
                    writer.event(*at, &event);
                }
            }
        }
    }
    let file = writer.finish();
    let mut in_file = BTreeMap::new();
    for message in mcap::MessageStream::new(&file).unwrap() {
        let message = message.unwrap();
        if message.channel.topic == topics[3] {
            let json = String::from_utf8(message.data.to_vec()).unwrap();
            in_file.insert(json, message.log_time);
        }
    }
    let of = |id| client.messages.iter().filter(move |(of, ..)| *of == id);
    let zero: BTreeSet<_> = of(0).map(|(_, ns, json)| ns - in_file[json]).collect();
    assert_eq!(zero.len(), 1, "one offset of the wall clock");
    assert!(of(0).count() > 5, "{} messages", of(0).count());
    let (_, first, _) = of(0).next().unwrap();
    // To the time that a message waits, and the precision of the clocks.
    assert!(first.abs_diff(before) < 1_000_000_000);
    for (_, _, json) in &client.messages {
        assert!(RawJson::parse(json).is_ok(), "{json}");
    }
    let frames: usize = of(10)
        .map(|(.., json)| json.matches("after_us").count())
        .sum();
    assert!(frames >= 2 * of(0).count() - 4, "{frames} frames");
}

fn unix_ns() -> u64 {
    let unix = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    u64::try_from(unix.unwrap().as_nanos()).unwrap()
}

#[test]
fn a_client_that_knows_the_older_name_is_answered_and_another_protocol_is_not() {
    let bench = Bench::start(None);
    let of = |name| connect(&bench, "", &[("Sec-WebSocket-Protocol", name)]);
    let older = of("foxglove.websocket.v1").unwrap();
    assert_eq!(older.protocol, "foxglove.websocket.v1");
    assert!(of("mqtt").is_err());
    assert!(connect(&bench, "", &[]).is_err());
    assert_ne!(bench.get("/foxglove", &bench.host()).0, 200);
}

/// PlotJuggler 4 has fields for address and port only.
#[test]
fn a_client_without_a_path_is_answered_by_the_same_rules() {
    let plot_juggler = ("Sec-WebSocket-Protocol", "foxglove.sdk.v1");
    let at = |bench: &Bench, path: &str, origin: &str| {
        connect_at(bench, path, &[plot_juggler, ("Origin", origin)]).is_ok()
    };
    let bench = Bench::start(None);
    let own = format!("ws://{}", bench.address);
    assert!(at(&bench, "/", &own));
    assert!(!at(&bench, "/", "https://evil.example"));
    assert!(!at(&bench, "/index.html", &own));
    let bench = Bench::start(Some(Token::new().unwrap()));
    let token = bench.token.as_ref().unwrap();
    assert!(!at(&bench, "/", &own));
    assert!(at(&bench, &format!("/?token={token}"), &own));
}

#[test]
fn without_a_token_only_programs_of_this_computer_and_foxglove_watch() {
    let bench = Bench::start(None);
    let own = format!("http://{}", bench.address);
    let allowed = [
        own.as_str(),
        "https://app.foxglove.dev",
        "http://localhost:8080",
        "http://127.0.0.1",
        "http://[::1]:3000",
        "file://",
        // PlotJuggler 4 on this computer.
        &format!("ws://{}", bench.address),
    ];
    for origin in allowed {
        assert_eq!(status(&bench, "", &[("Origin", origin)]), 101, "{origin}");
    }
    let refused = [
        "https://evil.example",
        "http://app.foxglove.dev",
        "https://app.foxglove.dev.evil.example",
        "https://localhost.evil.example",
        "http://127.0.0.1.evil.example",
        "http://user@localhost.evil.example",
        "https://foxglove.dev",
        "null",
        "",
    ];
    for origin in refused {
        assert_eq!(status(&bench, "", &[("Origin", origin)]), 403, "{origin}");
    }
    assert_eq!(status(&bench, "", &[("Host", "evil.example")]), 403);
}

#[test]
fn the_token_in_the_address_lets_any_program_watch_and_the_cookie_no_other_page() {
    let bench = Bench::start(Some(Token::new().unwrap()));
    let token = bench.token.as_ref().unwrap();
    let foreign = ("Origin", "https://plots.example");
    let right = format!("?token={token}");
    assert_eq!(status(&bench, &right, &[]), 101);
    assert_eq!(status(&bench, &right, &[foreign]), 101);
    let cookie = format!("motorlink-token={token}");
    let cookie = ("Cookie", cookie.as_str());
    assert_eq!(status(&bench, "", &[cookie]), 101);
    assert_eq!(status(&bench, "", &[cookie, foreign]), 403);
    let foxglove = ("Origin", "https://app.foxglove.dev");
    assert_eq!(status(&bench, "", &[cookie, foxglove]), 403);
    assert_eq!(status(&bench, "", &[]), 401);
    // Wrong ones count as those of pages do.
    for _ in 0..10 {
        let wrong = Token::new().unwrap();
        assert_eq!(status(&bench, &format!("?token={wrong}"), &[]), 401);
    }
    assert_eq!(status(&bench, &right, &[]), 429);
    assert_eq!(bench.get(&format!("/{right}"), &bench.host()).0, 429);
}

#[test]
fn what_a_client_sends_does_nothing_and_too_much_ends_it() {
    let entries = Arc::new(Mutex::new(Vec::new()));
    let taken = Arc::clone(&entries);
    let bench = Bench::start_with(None, move |_, entry| {
        if !matches!(entry, Entry::Event(Event::Line(_) | Event::Telemetry(_))) {
            taken.lock().unwrap().push(entry.clone());
        }
    });
    let mut sending = client(&bench);
    sending.wait("the channel of the motor", |client| {
        client.channels().contains_key(&TELEMETRY)
    });
    // The question for an ID at the start.
    entries.lock().unwrap().clear();
    for text in [
        "",
        "garbage",
        r#"{"op":"advertise","channels":[{"id":1,"topic":"/cmd_vel","encoding":"json","schemaName":"geometry_msgs/Twist"}]}"#,
        r#"{"op":"setParameters","parameters":[{"name":"speed_rpm","value":100}]}"#,
        r#"{"op":"subscribe","subscriptions":[{"id":1,"channelId":9}]}"#,
    ] {
        sending.texts.clear();
        sending.say(text);
        sending.wait("a complaint", |client| {
            client.has_text(r#""op":"status","level":2"#)
        });
    }
    // To publish, and to call a service; and an act of a page.
    for bytes in [&[1, 1, 0, 0, 0, b'{', b'}'][..], &[2; 40], &[3, 0, 0, 1]] {
        sending
            .socket
            .send(Message::binary(bytes.to_vec()))
            .unwrap();
    }
    sending.subscribe(0, TELEMETRY);
    sending.wait("telemetry", |client| client.messages.len() > 10);
    for (.., json) in &sending.messages {
        assert!(
            json.contains(r#""speed_rpm":0"#),
            "the wheel stands: {json}"
        );
        assert!(!json.contains("setpoint"), "{json}");
    }
    assert_eq!(*entries.lock().unwrap(), []);

    let mut long = client(&bench);
    let _ = long.socket.send(Message::text("x".repeat(100_000)));
    assert!(long.closes());
    let mut flood = client(&bench);
    for _ in 0..2_000 {
        if flood.socket.send(Message::text("{}")).is_err() {
            break;
        }
    }
    assert!(flood.closes());
    let count = sending.messages.len();
    sending.wait("more telemetry", |client| client.messages.len() > count);
}

#[test]
fn clients_are_limited_and_those_that_read_nothing_delay_no_other() {
    let bench = Bench::start(None);
    let mut deaf: Vec<_> = (0..7).map(|_| client(&bench)).collect();
    let mut reading = client(&bench);
    reading.wait("the channel of the motor", |client| {
        client.channels().contains_key(&TELEMETRY)
    });
    let mut further = client(&bench);
    assert!(further.closes());
    for client in &mut deaf {
        for channel in [1, 3, TELEMETRY] {
            client.subscribe(channel, channel);
        }
    }
    reading.subscribe(0, TELEMETRY);
    reading.wait("telemetry", |client| !client.messages.is_empty());
    let (began, mut newest, mut gap) = (Instant::now(), Instant::now(), Duration::ZERO);
    let mut count = reading.messages.len();
    while began.elapsed() < Duration::from_secs(2) {
        assert!(reading.receive());
        if reading.messages.len() > count {
            gap = gap.max(newest.elapsed());
            newest = Instant::now();
            count = reading.messages.len();
        }
    }
    println!("{count} messages, the longest gap {gap:?}");
    assert!(
        count > 10 && gap < Duration::from_secs(1),
        "{count}, {gap:?}"
    );
    assert!(!reading.has_text("too slow"));
}

/// The client of the makers of the protocol, from a page of another origin.
#[test]
#[ignore = "needs npm packages: cargo xtask test --only foxglove-client"]
fn the_client_of_foxglove_watches() {
    let packages = env::var_os("MOTORLINK_FOXGLOVE_CLIENT")
        .expect("MOTORLINK_FOXGLOVE_CLIENT names the folder of the npm packages");
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/foxglove_client.mjs");
    let token = Token::new().unwrap();
    for (token, origin) in [
        (None, "https://app.foxglove.dev"),
        (Some(token), "https://plots.example"),
    ] {
        let bench = Bench::start(token);
        let token = bench.token.as_ref();
        let query = token.map(|token| format!("?token={token}"));
        let query = query.unwrap_or_default();
        let url = format!("ws://{}/foxglove{query}", bench.address);
        let mut command = Command::new("node");
        command
            .args([script.as_ref(), &*packages])
            .args([url.as_str(), origin]);
        assert!(command.status().unwrap().success());
    }
}
