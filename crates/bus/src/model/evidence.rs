//! What replies tell about the model of the motors.

use std::time::Duration;

use motorlink_protocol::{
    FRAME_LEN, Frame, Instant, Mode, MotorId,
    family::{FrameSet, Model},
};

/// This many frames in a row with the ID of one motor, and none of the model of the line with that ID between them, show
/// another model. Fewer may be noise: about one in 256 garbled frames has a good CRC.
const FRAMES: u8 = 3;

/// Each of these frames comes within this time of the one before. A silent motor is asked every 8 s while others are
/// driven, and a DDSM115 answers only every second query for a DDSM210.
const WITHIN: Duration = Duration::from_secs(20);

/// What replies have told about the model of the motors.
#[derive(Clone, Debug, Default)]
pub(crate) struct ModelEvidence {
    /// Whether a motor has answered as the model of the line.
    pub(crate) own: bool,
    /// The other model that the replies show, until the operator releases the motors.
    pub(crate) other: Option<Model>,
    /// The model of the last frame of another model.
    last: Option<Model>,
    /// At most one for each ID.
    rows: Vec<Row>,
}

/// Frames in a row of one motor of another model.
#[derive(Clone, Copy, Debug)]
struct Row {
    id: MotorId,
    model: Model,
    frames: u8,
    last: Instant,
}

impl ModelEvidence {
    /// Records a reply of the model of the line: earlier frames of another model with this ID were noise.
    pub(crate) fn own_reply(&mut self, id: MotorId) {
        self.own = true;
        self.rows.retain(|row| row.id != id);
    }

    /// Records a frame of another model. Returns whether the replies show that model from now on.
    pub(crate) fn other_reply(&mut self, now: Instant, id: MotorId, found: Model) -> bool {
        self.last = Some(found);
        let goes_on =
            |row: &&Row| row.id == id && row.model == found && now.since(row.last) <= WITHIN;
        let before = self.rows.iter().find(goes_on).map_or(0, |row| row.frames);
        let frames = before.saturating_add(1);
        self.rows.retain(|row| row.id != id);
        self.rows.push(Row {
            id,
            model: found,
            frames,
            last: now,
        });
        let is_new = frames >= FRAMES && self.other.is_none();
        if is_new {
            self.other = Some(found);
        }
        is_new
    }

    /// The operator releases the motors: the other model may be gone. One more frame of a motor that has just shown
    /// it is enough to show it again.
    pub(crate) fn release(&mut self, now: Instant) {
        self.other = None;
        self.rows.retain(|row| now.since(row.last) <= WITHIN);
        for row in &mut self.rows {
            row.frames = row.frames.min(FRAMES - 1);
        }
    }

    /// Whether the last frames with this ID were of another model.
    pub(crate) fn suspects(&self, id: MotorId) -> bool {
        self.rows.iter().any(|row| row.id == id)
    }

    /// The other model that the last foreign frame has shown.
    pub(crate) const fn likely(&self) -> Option<Model> {
        self.last
    }
}

/// The motor and the other model whose reply this is, on a line of `model`. A frame with a good CRC that could be a
/// request is not one: it may come from another host.
pub(crate) fn other_model(model: Model, frame: &Frame) -> Option<(MotorId, Model)> {
    let &[id, command, b2, b3, b4, b5, b6, b7, b8, _] = frame.bytes();
    let motor = MotorId::new(id).ok().filter(|_| id != 0xC8)?;
    if !frame.crc_holds() {
        return None;
    }
    // A host sends 00 or FF in place of the temperature, and only zeros behind an odometry query.
    let has_temperature = !matches!(b7, 0 | 0xFF);
    let has_angle = [b2, b3, b4, b5, b6, b7, b8] != [0; 7];
    let offset = match model.spec().frames {
        FrameSet::Combined => None,
        FrameSet::Separate { reply_offset } => Some(reply_offset),
    };
    let found = match command {
        _ if offset.is_some() && Mode::from_byte(command).is_ok() => Some(Model::Ddsm115),
        0x64 if offset != Some(0) && has_temperature => Some(Model::Ddsm210),
        0x74 if offset != Some(0) && has_angle => Some(Model::Ddsm210),
        0x65 if offset != Some(1) && has_temperature => Some(Model::Ddsm400),
        _ => None,
    };
    found.map(|found| (motor, found))
}

/// Whether these bytes are a whole drive frame. If the bus has not sent it, another host has.
pub(crate) fn is_drive_frame(bytes: &[u8]) -> bool {
    let frame = <[u8; FRAME_LEN]>::try_from(bytes).map(Frame::new);
    frame.is_ok_and(|frame| {
        let [id, command, ..] = *frame.bytes();
        command == 0x64 && MotorId::new(id).is_ok() && frame.crc_holds()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const ID: MotorId = MotorId::FIRST;

    fn at(ms: u64) -> Instant {
        Instant::ZERO + Duration::from_millis(ms)
    }

    fn frame(text: &str) -> Frame {
        let [body @ .., _] = *text.parse::<Frame>().unwrap().bytes();
        Frame::with_crc(body)
    }

    #[test]
    fn a_reply_shows_its_model() {
        let of_115 = frame("01 02 00 0A 00 00 20 F6 00 00");
        let of_210 = frame("01 64 03 E8 00 10 00 1E 00 00");
        let of_400 = frame("01 65 03 E8 00 10 00 1E 00 00");
        let odometry = frame("01 74 00 00 00 02 10 00 00 00");
        for (line, reply, other) in [
            (Model::Ddsm115, of_115, None),
            (Model::Ddsm315, of_210, Some(Model::Ddsm210)),
            (Model::Ddsm115, of_400, Some(Model::Ddsm400)),
            (Model::Ddsm115, odometry, Some(Model::Ddsm210)),
            (Model::Ddsm210, of_115, Some(Model::Ddsm115)),
            (Model::Ddsm210, of_210, None),
            (Model::Ddsm210, odometry, None),
            (Model::Ddsm210, of_400, Some(Model::Ddsm400)),
            (Model::Ddsm400, of_400, None),
            (Model::Ddsm400, of_210, Some(Model::Ddsm210)),
        ] {
            let other = other.map(|other| (MotorId::FIRST, other));
            assert_eq!(other_model(line, &reply), other, "{line} {reply}");
        }
    }

    #[test]
    fn a_frame_of_another_host_shows_no_model() {
        for text in [
            "01 64 00 64 00 00 00 00 00 00",
            "01 64 00 00 00 00 00 FF 00 00",
            "01 74 00 00 00 00 00 00 00 00",
            "01 A0 02 00 00 00 00 00 00 00",
            "C8 64 00 00 00 00 00 1E 00 00",
        ] {
            for line in Model::ALL {
                assert_eq!(other_model(line, &frame(text)), None, "{line} {text}");
            }
        }
    }

    #[test]
    fn three_frames_in_a_row_show_another_model_once() {
        let mut evidence = ModelEvidence::default();
        assert!(!evidence.other_reply(at(0), ID, Model::Ddsm210));
        assert!(!evidence.other_reply(at(20_001), ID, Model::Ddsm210));
        assert!(!evidence.other_reply(at(40_001), ID, Model::Ddsm210));
        assert_eq!(evidence.likely(), Some(Model::Ddsm210));
        assert!(evidence.other_reply(at(60_001), ID, Model::Ddsm210));
        assert!(!evidence.other_reply(at(60_002), ID, Model::Ddsm210));
        evidence.release(at(61_000));
        assert!(evidence.other.is_none() && evidence.suspects(ID));
        assert!(evidence.other_reply(at(62_000), ID, Model::Ddsm210));
        evidence.release(at(90_000));
        assert!(!evidence.suspects(ID));
    }

    #[test]
    fn chance_frames_show_no_other_model() {
        let mut evidence = ModelEvidence::default();
        let second = MotorId::new(2).unwrap();
        for round in 0..10 {
            assert!(!evidence.other_reply(at(round), ID, Model::Ddsm115));
            assert!(!evidence.other_reply(at(round), second, Model::Ddsm115));
            // The one answers, the other has another model each time.
            evidence.own_reply(ID);
            assert!(!evidence.other_reply(at(round), second, Model::Ddsm400));
        }
        for address in 3..100 {
            let id = MotorId::new(address).unwrap();
            assert!(!evidence.other_reply(at(20), id, Model::Ddsm115));
        }
    }

    #[test]
    fn a_drive_frame_of_another_host_is_recognized() {
        let is_drive = |text| is_drive_frame(frame(text).bytes());
        assert!(is_drive("01 64 40 00 00 00 00 00 00 00"));
        assert!(!is_drive("01 65 40 00 00 00 00 1E 00 00"), "a reply");
        assert!(!is_drive("01 74 00 00 00 00 00 00 00 00"), "a query");
        assert!(!is_drive_frame(&[1, 0x64, 0x40]));
    }
}
