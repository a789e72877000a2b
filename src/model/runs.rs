//! Who gets the messages of the run of an experiment. Everything else about runs loads with the panel `Experiments`.

use std::{cell::RefCell, hint::black_box, rc::Rc};

/// Gets a [`FromRun`](motorlink_messages::runs::FromRun), encoded.
pub(crate) type Receiver = Rc<dyn Fn(&[u8])>;

thread_local! {
    static RECEIVER: RefCell<Option<Receiver>> = const { RefCell::new(None) };
}

/// Sets who gets the messages from now on.
pub(crate) fn set_receiver(receiver: Receiver) {
    // There is only one, which the optimizer would find and bring into the first program.
    RECEIVER.set(Some(black_box(receiver)));
}

/// Passes a message on.
pub(crate) fn receive(message: &[u8]) {
    let receiver = RECEIVER.with_borrow(Clone::clone);
    if let Some(receiver) = receiver {
        receiver(message);
    }
}
