use super::*;

#[test]
fn a_number_in_range_is_a_value() {
    for (entry, text, value) in [
        (SPEED, "-330", -330),
        (SPEED, " +100 ", 100),
        (SPEED, "\u{2212}50", -50),
        (ACCELERATION, "255", 255),
        (CURRENT, "32767", 32_767),
        (OUTPUT, "-32767", -32_767),
        (POSITION, "0", 0),
        (ANGLE, "360", 32_767),
        (ANGLE, "90,0", 8_192),
        (ANGLE, "45.5°", 4_141),
        (ANGLE, ".5", 46),
        (ANGLE, "7.", 637),
        (RATE, "500", 500),
        (SPEED_LIMIT, "1", 1),
        (CURRENT_LIMIT, "2.7", 2_700),
        (CURRENT_LIMIT, "8", 8_000),
        (CURRENT_LIMIT, "0,1", 100),
        (TEMPERATURE_LIMIT, "80", 80),
    ] {
        assert_eq!(entry.read(text), Typed::Value(value), "{text}");
    }
}

#[test]
fn out_of_range_names_the_range() {
    for (entry, text, range) in [
        (SPEED, "381", "-380 to 380"),
        (SPEED, "99999999999", "-380 to 380"),
        (SPEED.limited(210), "211", "-210 to 210"),
        (ACCELERATION, "-1", "0 to 255"),
        (CURRENT, "-32768", "-32767 to 32767"),
        (OUTPUT, "32768", "-32767 to 32767"),
        (POSITION, "32768", "0 to 32767"),
        (ANGLE, "361", "0 to 360"),
        (ANGLE, "360.001", "0 to 360"),
        (
            ANGLE,
            "99999999999999999999999999999999999999999999",
            "0 to 360",
        ),
        (ANGLE, "-1", "0 to 360"),
        (RATE, "0", "1 to 500"),
        (SPEED_LIMIT, "0", "1 to 380"),
        (SPEED_LIMIT.limited(210), "211", "1 to 210"),
        (AMPS, "8.1", "\u{2212}8.00 to +8.00 A"),
        (AMPS.limited(16_383), "4.1", "\u{2212}4.00 to +4.00 A"),
        (AMPS, "-99999999999", "\u{2212}8.00 to +8.00 A"),
        (CURRENT_LIMIT, "0", "0.1 to 8 A"),
        (CURRENT_LIMIT, "8.1", "0.1 to 8 A"),
        (CURRENT_LIMIT.limited(4_000), "4.1", "0.1 to 4 A"),
        (CURRENT_LIMIT, "-3", "0.1 to 8 A"),
        (CURRENT_LIMIT, "99999999999999999999", "0.1 to 8 A"),
        (TEMPERATURE_LIMIT, "81", "30 to 80"),
    ] {
        let Typed::Wrong(words) = entry.read(text) else {
            panic!("{text} was taken");
        };
        assert!(words.contains(range), "{words}");
        assert!(words.ends_with('.'), "{words}");
    }
}

#[test]
fn unfinished_input_gives_no_error() {
    for text in ["", "-", " + ", "\u{2212}"] {
        assert_eq!(SPEED.read(text), Typed::Unfinished, "{text:?}");
    }
    assert_eq!(
        SPEED.read("12a"),
        Typed::Wrong(tr!("Enter a whole number.").to_owned())
    );
    for text in ["NaN", "1e2", "1.2.3", ".", "--1", "inf"] {
        let words = tr!("Enter the angle in degrees.").to_owned();
        assert_eq!(ANGLE.read(text), Typed::Wrong(words), "{text}");
    }
}

#[test]
fn keys_move_what_is_shown_and_end_at_the_range() {
    assert_eq!(SPEED.moved(100, SPEED.step), 101);
    assert_eq!(SPEED.moved(375, SPEED.page), 380);
    assert_eq!(POSITION.moved(50, -POSITION.step), 0);
    // From 44.99 degrees to 46.
    assert_eq!(ANGLE.moved(4_095, ANGLE.step), 4_187);
    assert_eq!(CURRENT_LIMIT.moved(2_700, CURRENT_LIMIT.step), 2_800);
    assert_eq!(CURRENT_LIMIT.moved(2_700, -CURRENT_LIMIT.page), 1_700);
    assert_eq!(CURRENT_LIMIT.moved(7_900, CURRENT_LIMIT.page), 8_000);
}

#[test]
fn amps_are_a_raw_current() {
    for (text, raw) in [("2", 8_192), ("-0,5", -2_048), ("8 A", 32_767), ("0", 0)] {
        assert_eq!(AMPS.read(text), Typed::Value(raw), "{text}");
    }
    // 4 A is between two raw numbers.
    assert_eq!(AMPS.limited(16_383).read("4"), Typed::Value(16_383));
    assert_eq!((AMPS.show)(-2_048), "\u{2212}0.50");
    assert_eq!(AMPS.moved(2_048, AMPS.step), 2_253);
    assert_eq!(AMPS.plain(-2_048), "-0.50");
}

#[test]
fn what_is_shown_is_read_as_the_same() {
    for entry in [
        SPEED,
        ACCELERATION,
        CURRENT,
        POSITION,
        ANGLE,
        RATE,
        SPEED_LIMIT,
        TEMPERATURE_LIMIT,
    ] {
        for value in [entry.min, entry.min + 1, entry.max / 2, entry.max] {
            let shown = (entry.show)(value);
            assert_eq!(entry.read(&shown), Typed::Value(value), "{shown}");
        }
    }
}
