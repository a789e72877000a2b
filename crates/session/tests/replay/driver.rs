//! Drives a player over virtual time.

use std::time::Duration;

use motorlink_messages::{
    Update,
    sessions::{FromReplay, Place, PlaySpeed, ToReplay},
};
use motorlink_protocol::Instant;
use motorlink_recorder::LocalTime;
use motorlink_session::{LookBack, Player, Session, Source, Todo, open, overview};

pub struct Replay<'a> {
    file: &'a [u8],
    session: Session,
    pub player: Player,
    pub now: Instant,
    pub messages: Vec<FromReplay>,
    /// When the player wants to be polled again.
    pub due: Option<Instant>,
    /// Number of polls.
    pub polls: usize,
}

impl<'a> Replay<'a> {
    pub fn of(file: &'a [u8]) -> Self {
        Self::with(file, LookBack::default()).unwrap()
    }

    /// `None` if the file is no session.
    pub fn with(file: &'a [u8], look_back: LookBack) -> Option<Self> {
        let mut source = file;
        let session = open(&mut source).unwrap().ok()?;
        let (whole, _) = overview(&mut source, &session).unwrap();
        let local_time = LocalTime::fixed(60);
        let player = Player::with_look_back(&session, &whole, local_time, look_back);
        let mut replay = Self {
            file,
            session,
            player,
            now: Instant::from_millis(77_000),
            messages: Vec::new(),
            due: None,
            polls: 0,
        };
        replay.settle();
        Some(replay)
    }

    /// Polls once, and does what is asked. Returns whether there is more to do at once.
    pub fn step(&mut self) -> bool {
        self.polls += 1;
        assert!(self.polls < 5_000_000, "it hangs");
        match self.player.poll(&self.session, self.now) {
            Todo::Read(range) => {
                let bytes = self.file.read(range.clone()).unwrap();
                self.player.supply(&range, &bytes);
            }
            Todo::Post(message) => self.messages.push(message),
            Todo::Work => {}
            Todo::Wait(due) => {
                self.due = due;
                return due.is_some_and(|due| due <= self.now);
            }
        }
        true
    }

    pub fn settle(&mut self) {
        while self.step() {}
    }

    pub fn handle(&mut self, message: ToReplay) {
        self.player.handle(&self.session, message, self.now);
    }

    /// Handles a message and all that follows at once. Returns what was posted.
    pub fn ask(&mut self, message: ToReplay) -> Vec<FromReplay> {
        let before = self.messages.len();
        self.handle(message);
        self.settle();
        self.messages[before..].to_vec()
    }

    pub fn run(&mut self, duration: Duration) {
        let end = self.now + duration;
        loop {
            self.settle();
            match self.due.filter(|due| *due <= end) {
                Some(due) => self.now = due,
                None => break,
            }
        }
        self.now = end;
        self.settle();
    }

    pub fn play(&mut self, per_mille: u32) {
        self.handle(ToReplay::Play(PlaySpeed::from_per_mille(per_mille)));
        self.settle();
    }

    /// Goes to this time of the session.
    pub fn seek(&mut self, at: Instant) -> Update {
        let first = self.begun().0;
        let after_us = at.since(first).as_micros().try_into().unwrap();
        let messages = self.ask(ToReplay::Seek { after_us });
        let (_, update) = updates(&messages).last().unwrap();
        update.clone()
    }

    /// The first time, and the duration in microseconds.
    pub fn begun(&self) -> (Instant, u64) {
        match self.messages.first() {
            Some(FromReplay::Begun {
                first, duration_us, ..
            }) => (*first, *duration_us),
            other => panic!("{other:?}"),
        }
    }

    /// The last place that was shown, in microseconds; 0 without one.
    pub fn last_place(&self) -> u64 {
        updates(&self.messages)
            .last()
            .map_or(0, |one| one.0.after_us)
    }

    pub fn last(&self) -> (Place, &Update) {
        updates(&self.messages).last().unwrap()
    }
}

pub fn updates(messages: &[FromReplay]) -> impl Iterator<Item = (Place, &Update)> {
    messages.iter().filter_map(|message| match message {
        FromReplay::Update { place, update } => Some((*place, &**update)),
        _ => None,
    })
}
