use proptest::prelude::*;

use super::*;

fn sample() -> Vec<LineEvent> {
    let drive = "01 64 00 64 00 00 00 00 00 4F".parse().unwrap();
    let reply = "01 02 02 CD 00 64 17 CF 00 8F".parse().unwrap();
    let kinds = [
        LineEventKind::Sent {
            frame: drive,
            mode: Some(Mode::Velocity),
        },
        LineEventKind::Received {
            frame: reply,
            asked: Some(Layout::Drive),
        },
        LineEventKind::NotSent { frame: drive },
        LineEventKind::Silence {
            id: MotorId::FIRST,
            waited_us: 8_000,
        },
        LineEventKind::Junk(JunkBytes::new(&[1, 0xFF])),
    ];
    let at = (0..).map(|n| Instant::from_micros(5_000_000 + 1_700 * n));
    at.zip(kinds)
        .map(|(at, kind)| LineEvent { at, kind })
        .collect()
}

fn written(events: &[LineEvent]) -> Vec<String> {
    let mut batch = Batch::default();
    let mut messages = Vec::new();
    for event in events {
        if batch.is_full_for(event.at) {
            messages.push(batch.end().unwrap().1.to_owned());
        }
        batch.push(event);
    }
    messages.extend(batch.end().map(|(_, json)| json.to_owned()));
    messages
}

#[test]
fn a_message_is_json_that_says_everything() {
    let expected = concat!(
        r#"{"mono_us":5000000,"frames":["#,
        r#"{"after_us":0,"direction":"tx","sent":true,"id":1,"mode":"velocity","hex":"0164006400000000004F"},"#,
        r#"{"after_us":1700,"direction":"rx","id":1,"layout":"drive","hex":"010202CD006417CF008F"},"#,
        r#"{"after_us":1700,"direction":"tx","sent":false,"id":1,"hex":"0164006400000000004F"},"#,
        r#"{"after_us":1700,"direction":"rx","id":1,"silent_us":8000,"hex":""},"#,
        r#"{"after_us":1700,"direction":"rx","junk":true,"hex":"01FF"}]}"#,
    );
    assert_eq!(written(&sample()), [expected]);
}

#[test]
fn another_model_is_named_and_what_is_known_has_no_frame() {
    let mut batch = Batch::default();
    batch.set_model(Model::Ddsm210);
    let (id, mode) = (MotorId::FIRST, Mode::OpenLoop);
    let known = |value| LineEvent {
        at: Instant::from_micros(7),
        kind: LineEventKind::Known { id, mode, value },
    };
    let known = [known(Some([0xFE, 0x0C])), known(None)];
    for event in &known {
        batch.push(event);
    }
    let (_, json) = batch.end().unwrap();
    let expected = concat!(
        r#"{"mono_us":7,"model":"ddsm210","frames":["#,
        r#"{"after_us":0,"direction":"tx","known":true,"id":1,"mode":"open_loop","hex":"FE0C"},"#,
        r#"{"after_us":0,"direction":"tx","known":true,"id":1,"mode":"open_loop","hex":""}]}"#,
    );
    assert_eq!(json, expected);
    let content = read(json.as_bytes()).unwrap();
    assert_eq!(
        (content.model, content.events),
        (Model::Ddsm210, known.to_vec())
    );
}

/// Earlier versions wrote frames of a DDSM115 beside those in separate frames.
#[test]
fn a_frame_that_was_on_no_line_is_not_read() {
    let message = concat!(
        r#"{"mono_us":7,"model":"ddsm210","frames":["#,
        r#"{"after_us":0,"direction":"tx","sent":true,"id":1,"mode":"open loop","hex":"016401F40000000000C3"},"#,
        r#"{"after_us":0,"direction":"tx","derived":true,"id":1,"mode":"open loop","hex":"016401F40000000000C3"},"#,
        r#"{"after_us":9,"direction":"rx","id":1,"hex":"016401F40000001F0037"},"#,
        r#"{"after_us":0,"direction":"rx","derived":true,"id":1,"layout":"temperature","hex":"01020000003217CF008F"}]}"#,
    );
    let content = read(message.as_bytes()).unwrap();
    assert!(content.is_complete);
    let frame = |hex: &str| Frame::new(bytes_of(hex).unwrap().0);
    let expected = [
        LineEventKind::Sent {
            frame: frame("016401F40000000000C3"),
            mode: Some(Mode::OpenLoop),
        },
        LineEventKind::Received {
            frame: frame("016401F40000001F0037"),
            asked: None,
        },
    ];
    let kinds: Vec<_> = content.events.iter().map(|event| event.kind).collect();
    assert_eq!(kinds, expected);
}

/// Earlier versions wrote the replies of which only the recording was left as derived. Of a DDSM115 they are those of the
/// line, of a DDSM210 nothing is left of them.
#[test]
fn replies_of_a_recording_of_an_earlier_version_are_read_or_said_to_be_lost() {
    let message = concat!(
        r#"{"mono_us":7,"frames":["#,
        r#"{"after_us":0,"direction":"tx","derived":true,"id":1,"mode":"velocity","hex":"0164006400000100008A"},"#,
        r#"{"after_us":0,"direction":"rx","derived":true,"id":1,"layout":"drive","hex":"010202CD006417CF008F"},"#,
        r#"{"after_us":5,"direction":"rx","derived":true,"id":1,"layout":"drive","hex":"010202CD006417CF008F"}]}"#,
    );
    let content = read(message.as_bytes()).unwrap();
    assert!(content.is_complete);
    let frame = Frame::new(bytes_of("010202CD006417CF008F").unwrap().0);
    let asked = Some(Layout::Drive);
    let reply = LineEventKind::Received { frame, asked };
    let known = LineEventKind::Known {
        id: MotorId::FIRST,
        mode: Mode::Velocity,
        value: Some([0, 0x64]),
    };
    let kinds: Vec<_> = content.events.iter().map(|event| event.kind).collect();
    assert_eq!(kinds, [known, reply, reply]);
    let of_another = message.replace("{\"mono_us\":7,", "{\"mono_us\":7,\"model\":\"ddsm210\",");
    let content = read(of_another.as_bytes()).unwrap();
    assert!(content.events.is_empty() && !content.is_complete);
}

#[test]
fn a_message_spans_a_tenth_of_a_second_at_most() {
    let of = |at| LineEvent {
        at: Instant::from_micros(at),
        kind: LineEventKind::Junk(JunkBytes::new(&[1])),
    };
    assert_eq!(written(&[of(0), of(99_999)]).len(), 1);
    assert_eq!(written(&[of(0), of(100_000)]).len(), 2);
    assert_eq!(written(&[of(10), of(9)]).len(), 2, "a time that goes back");
    assert_eq!(written(&vec![of(0); 257]).len(), 2);
}

#[test]
fn what_cannot_be_read_is_said() {
    for frame in [
        "{}",
        "7",
        r#"{"direction":"tx","hex":"01"}"#,
        r#"{"direction":"up","hex":"0164006400000000004F"}"#,
        r#"{"direction":"rx","hex":"0164006400000000004X"}"#,
        r#"{"direction":"rx","id":0,"silent_us":1}"#,
        r#"{"direction":"rx","hex":"+1+1+1+1+1+1+1+1+1+1"}"#,
        r#"{"after_us":-1,"direction":"rx","hex":"0164006400000000004F"}"#,
    ] {
        let message = format!(r#"{{"mono_us":1,"frames":[{frame}]}}"#);
        let content = read(message.as_bytes()).unwrap();
        assert!(content.events.is_empty() && !content.is_complete, "{frame}");
    }
    for message in ["", "{}", "[]", r#"{"mono_us":1}"#, r#"{"frames":[]}"#] {
        assert_eq!(read(message.as_bytes()), None, "{message}");
    }
}

fn kind() -> impl Strategy<Value = LineEventKind> {
    let frame = any::<[u8; 10]>().prop_map(Frame::new);
    let mode = prop_oneof![
        Just(None),
        Just(Some(Mode::Current)),
        Just(Some(Mode::Position))
    ];
    let layout = prop_oneof![
        Just(None),
        Just(Some(Layout::Drive)),
        Just(Some(Layout::Query))
    ];
    prop_oneof![
        (frame.clone(), mode).prop_map(|(frame, mode)| LineEventKind::Sent { frame, mode }),
        (1..=254_u8, any::<Option<[u8; 2]>>()).prop_map(|(id, value)| LineEventKind::Known {
            id: MotorId::new(id).unwrap(),
            mode: Mode::OpenLoop,
            value,
        }),
        (frame.clone(), layout).prop_map(|(frame, asked)| LineEventKind::Received { frame, asked }),
        frame.prop_map(|frame| LineEventKind::NotSent { frame }),
        prop::collection::vec(any::<u8>(), 0..10)
            .prop_map(|junk| LineEventKind::Junk(JunkBytes::new(&junk))),
        (1..=254_u8, any::<u32>()).prop_map(|(id, waited_us)| LineEventKind::Silence {
            id: MotorId::new(id).unwrap(),
            waited_us
        }),
    ]
}

proptest! {
    #[test]
    fn what_was_written_is_read(
        events in prop::collection::vec((0..1_u64 << 50, kind()), 1..300)
    ) {
        let events: Vec<LineEvent> = events
            .into_iter()
            .map(|(at, kind)| LineEvent { at: Instant::from_micros(at), kind })
            .collect();
        let mut again = Vec::new();
        for message in written(&events) {
            let content = read(message.as_bytes()).unwrap();
            prop_assert!(content.is_complete);
            again.extend(content.events);
        }
        prop_assert_eq!(again, events);
    }
}
