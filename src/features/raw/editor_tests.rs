use super::*;

/// Drive at +100 rpm, as DFRobot's tutorial prints it.
const DRIVE: [u8; 10] = [0x01, 0x64, 0x00, 0x64, 0x00, 0x00, 0x00, 0x00, 0x00, 0x4F];

fn frame(text: &str) -> Option<[u8; 10]> {
    Entered::read(text).frame().map(|frame| *frame.bytes())
}

fn outcome(text: &str) -> Outcome {
    Entered::read(text).outcome()
}

/// The first invalid byte: its index, its characters and the reason.
fn wrong(text: &str) -> (usize, String, Why) {
    let entered = Entered::read(text);
    let Outcome::Wrong(place) = entered.outcome() else {
        panic!("{text:?} is {entered:?}");
    };
    match entered.pieces()[place].clone() {
        Piece::Wrong { text, why } => (place, text, why),
        piece => panic!("{piece:?}"),
    }
}

/// The bytes in every usual form.
fn forms(bytes: &[u8]) -> Vec<String> {
    let each = |form: fn(&u8) -> String| bytes.iter().map(form).collect::<Vec<String>>();
    let upper = each(|byte| format!("{byte:02X}"));
    let lower = each(|byte| format!("{byte:02x}"));
    let prefixed = each(|byte| format!("0x{byte:02X}"));
    let loud = each(|byte| format!("0X{byte:02x}"));
    let short = each(|byte| format!("0x{byte:x}"));
    let mixed: Vec<String> = (upper.iter().zip(&lower).enumerate())
        .map(|(place, (upper, lower))| if place % 2 == 0 { upper } else { lower }.clone())
        .collect();
    vec![
        upper.join(" "),
        lower.join(" "),
        mixed.join(" "),
        upper.join(""),
        lower.join(""),
        upper.join("\n"),
        upper.join("\r\n"),
        upper.join("\t"),
        upper.join(","),
        upper.join(", "),
        upper.join("; "),
        upper.join("-"),
        lower.join(":"),
        upper.join("|"),
        upper.join("\u{A0}"),
        format!("[{}]", upper.join(" ")),
        format!("  {}  \n", upper.join("  ")),
        format!("\"{}\"", upper.join(" ")),
        prefixed.join(" "),
        prefixed.join(","),
        short.join(", "),
        loud.join(" "),
        format!("{{ {} }}", prefixed.join(", ")),
        format!("({});", prefixed.join(", ")),
        format!("<{}>", lower.join(" ")),
        format!("0x{}", upper.join("")),
        // Pairs of bytes, as in a hex dump.
        upper
            .chunks(2)
            .map(<[String]>::concat)
            .collect::<Vec<_>>()
            .join(" "),
    ]
}

#[test]
fn ten_bytes_in_any_form_are_these_ten_bytes() {
    // Every byte value is at every index once, beside different neighbours.
    for round in 0..=255_u8 {
        let bytes: [u8; 10] = std::array::from_fn(|place| {
            let place = u8::try_from(place).unwrap();
            round.wrapping_mul(place * 2 + 1).wrapping_add(place)
        });
        for text in forms(&bytes) {
            assert_eq!(frame(&text), Some(bytes), "{text:?}");
        }
    }
}

#[test]
fn nine_bytes_in_any_form_get_their_crc() {
    for text in forms(&DRIVE[..9]) {
        let Outcome::Frame { frame, tenth } = outcome(&text) else {
            panic!("{text:?}");
        };
        assert_eq!(
            (frame.bytes(), tenth),
            (&DRIVE, Tenth::CrcAdded),
            "{text:?}"
        );
    }
}

#[test]
fn a_line_of_the_packet_log_is_its_bytes() {
    for text in [
        "13:15:36.962 TX 0x01 01 64 00 64 00 00 00 00 00 4F drive +100 rpm",
        "13:15:36.962\tTX\t0x01\t01 64 00 64 00 00 00 00 00 4F\tdrive +100 rpm, acceleration 1",
        "13:15:36.962\nTX\n0x01\n01 64 00 64 00 00 00 00 00 4F\nCRC is 4F",
        "TX 0x01 01 64 00 64 00 00 00 00 00 4F",
        "TX 01 64 00 64 00 00 00 00 00 4F",
        "13:15:36.962 TX – 01 64 00 64 00 00 00 00 00 4F heard by all",
        // A row of the export.
        "2026-05-01T13:15:36.962Z,1.234,TX,0x01,01 64 00 64 00 00 00 00 00 4F,\"drive, brake\"",
    ] {
        assert_eq!(frame(text), Some(DRIVE), "{text:?}");
    }
    let heard = "13:15:36.965 RX 0x01 01 02 02 CD 00 64 17 CF 00 8F +100 rpm, +0.175 A, 66.96°";
    assert_eq!(frame(heard).unwrap()[2..4], [0x02, 0xCD]);
}

#[test]
fn what_only_looks_like_a_line_of_the_log_is_not_read_as_one() {
    for text in [
        // Two log lines.
        "TX 0x01 01 64 00 64 00 00 00 00 00 4F\nRX 0x01 01 02 02 CD 00 64 17 CF 00 8F",
        // Bytes that the log does not write with a prefix.
        "TX 0x01 0x64 0x00 0x64 0x00 0x00 0x00 0x00 0x00 0x4F",
        // Bytes in the place of times.
        "01 64 00 TX 01 64 00 64 00 00 00 00 00 4F",
    ] {
        assert_eq!(wrong(text), (0, "TX".to_owned(), Why::NotOneLogLine));
    }
    // Junk in the log is too short, and its description contains no bytes.
    assert_eq!(outcome("RX 0x01 01 02 CRC is missing"), Outcome::TooFew(2));
    // Without a direction, a time is an invalid byte.
    let (place, text, _) = wrong("13:15:36.962 01 64 00 64 00 00 00 00 00 4F");
    assert_eq!((place, text.as_str()), (3, ".962"));
}

#[test]
fn what_is_wrong_is_wrong_at_its_byte() {
    for (text, place, characters, why) in [
        ("01 74 0G 00", 2, "0G", Why::NotHex),
        ("0174ZZ00", 2, "ZZ00", Why::NotHex),
        ("01 74 0 00", 2, "0", Why::OneDigit),
        ("017 64", 1, "7", Why::OneDigit),
        ("hello", 0, "hello", Why::NotHex),
        ("01 °C", 1, "°C", Why::NotHex),
        ("01 7° 00", 1, "7°", Why::NotHex),
        ("01 😀 00", 1, "😀", Why::NotHex),
        ("0x 64", 0, "0x", Why::NoDigits),
        ("0x0164 00", 0, "0x0164", Why::ManyDigits),
        ("01 0xG1 00", 1, "0xG1", Why::NotHex),
        ("01 +64", 1, "+64", Why::NotHex),
        ("0x010x64", 0, "0x010x64", Why::NotHex),
        ("01 64 00 64 00 00 00 00 00 4F FF", 10, "FF", Why::Surplus),
        ("0164006400000000 004FFFFF", 10, "FF", Why::Surplus),
        (
            "01 64 00 64 00 00 00 00 00 4F drive",
            10,
            "drive",
            Why::NotHex,
        ),
    ] {
        assert_eq!(wrong(text), (place, characters.to_owned(), why), "{text:?}");
        assert_eq!(frame(text), None, "{text:?}");
    }
}

#[test]
fn unfinished_input_gives_no_error() {
    assert_eq!(outcome(""), Outcome::Nothing);
    assert_eq!(outcome(" \n"), Outcome::Nothing);
    for (text, good) in [
        ("0", 0),
        ("01", 1),
        ("01 ", 1),
        ("01 7", 1),
        ("017", 1),
        ("01 0x", 1),
        ("01 0x7", 2),
        ("01 74 00 00 00 00 00 00 0", 8),
        ("01 74 00 00 00 00 00 00 00 0", 9),
    ] {
        assert_eq!(outcome(text), Outcome::TooFew(good), "{text:?}");
    }
    assert_eq!(Entered::read("01 7").pieces()[1], Piece::Half('7'));
}

#[test]
fn the_tenth_byte_says_what_it_is() {
    let tenth = |text| match outcome(text) {
        Outcome::Frame { tenth, .. } => tenth,
        outcome => panic!("{outcome:?}"),
    };
    for (text, wanted) in [
        ("01 64 00 64 00 00 00 00 00 4F", Tenth::Crc),
        ("01 64 00 64 00 00 00 00 00", Tenth::CrcAdded),
        (
            "01 64 00 64 00 00 00 00 00 5B",
            Tenth::WrongCrc { expected: 0x4F },
        ),
        ("01 A0 00 00 00 00 00 00 00 02", Tenth::Loop),
        ("AA 55 53 05 00 00 00 00 00", Tenth::ZeroAdded),
        ("AA 55 53 05 00 00 00 00 00 00", Tenth::NoCrc),
    ] {
        assert_eq!(tenth(text), wanted, "{text}");
    }
    // Only the user can say which loop ends a mode switch.
    assert_eq!(outcome("01 A0 00 00 00 00 00 00 00"), Outcome::LoopMissing);
    assert_eq!(frame("AA5553050000000000").unwrap()[9], 0);
}

#[test]
fn a_flood_of_text_is_read_no_further_than_needed() {
    let flood = "00 ".repeat(100_000);
    assert_eq!(Entered::read(&flood).pieces().len(), 11);
}
