//! Byte 8 of a reply: each bit, its fault and its name.

use motorlink_protocol::{Fault, Faults, family::Model};

/// The table in the maker's manual.
const TABLE: [(u8, Fault, &str); 5] = [
    (0b0000_0001, Fault::Sensor, "sensor"),
    (0b0000_0010, Fault::BusOvercurrent, "bus overcurrent"),
    (0b0000_0100, Fault::PhaseOvercurrent, "phase overcurrent"),
    (0b0000_1000, Fault::Stall, "stall"),
    (0b0001_0000, Fault::OverTemperature, "over-temperature"),
];

#[test]
fn each_fault_has_its_bit_and_its_name() {
    assert_eq!(
        Model::Ddsm115.spec().faults,
        TABLE.map(|(_, fault, _)| fault)
    );
    for (bit, fault, name) in TABLE {
        assert_eq!((fault.mask(), fault.name()), (bit, name));
        assert_eq!(Faults::NONE.with(fault).byte(), bit);
        assert_eq!(Faults::from_byte(bit).to_string(), name);
    }
}

#[test]
fn every_byte_is_read_bit_by_bit() {
    for byte in 0..=u8::MAX {
        let faults = Faults::from_byte(byte);
        assert_eq!(faults.byte(), byte);
        assert_eq!(faults.is_none(), byte == 0);
        assert_eq!(faults.any_named(), byte % 32 != 0, "{byte:08b}");
        assert_eq!(faults.unknown_bits(), byte / 32 * 32, "{byte:08b}");
        for (bit, fault, _) in TABLE {
            let is_active = byte / bit % 2 == 1;
            assert_eq!(faults.contains(fault), is_active, "{byte:08b} {fault:?}");
            assert_eq!(faults.iter().any(|other| other == fault), is_active);
        }
    }
}

#[test]
fn a_fault_is_added_once_and_removed_alone() {
    let two = Faults::from_byte(0b1001_1000);
    assert_eq!(two.with(Fault::Stall), two);
    assert_eq!(two.with(Fault::Sensor).byte(), 0b1001_1001);
    assert_eq!(two.without(Fault::Stall).byte(), 0b1001_0000);
    assert_eq!(two.without(Fault::Sensor), two);
}

#[test]
fn faults_are_joined_by_the_names_of_the_other_set() {
    let mine = Faults::from_byte(0b0101_0011);
    let other = Faults::of(Model::Ddsm210, 0b0011_0110);
    let joined = mine.joined(other);
    assert_eq!(joined, Faults::of(Model::Ddsm210, 0b0111_0111));
}

#[test]
fn faults_are_named_in_the_order_of_their_bits() {
    let written = |byte| Faults::from_byte(byte).to_string();
    assert_eq!(written(0), "OK");
    assert_eq!(written(0b0001_1000), "stall, over-temperature");
    assert_eq!(written(0b0010_0000), "unknown bits 0x20");
    assert_eq!(written(0b1000_0001), "sensor, unknown bits 0x80");
    assert_eq!(format!("{:?}", Faults::from_byte(8)), "stall (0x08)");
}
