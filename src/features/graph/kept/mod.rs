//! A run that the graph keeps, to draw it under another one: of another recording, or of the live motor.
//!
//! | file | idea |
//! |---|---|
//! | `alignment` | the moments at which two runs are laid over each other |
//! | `state` | the kept run, and what is chosen |
//! | `drawing` | its lines and its values |
//! | `controls` | the button `Keep run` and the row of the kept run |

pub(crate) mod alignment;
pub(crate) mod controls;
pub(crate) mod drawing;
pub(crate) mod state;
