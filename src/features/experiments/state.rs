//! What the panel knows: what is asked, what is armed, and the present run.

use std::rc::Rc;

use derive_more::Deref;
use leptos::prelude::*;
use motorlink_messages::{
    bus::CarriedRate,
    experiments::{
        plan::{Fleet, Plan},
        runner::{Options, Phase},
        sequence::{RunLimits, Sequence, SequenceError, Template},
        study::{Study, StudyKind},
        vehicle::Geometry,
    },
    runs::RunState,
};
use strum::{IntoStaticStr, VariantArray};

use crate::{
    features::experiments::{
        chart::Live,
        kept::KeptRuns,
        table::{self, Row},
        texts,
    },
    model::{
        local_storage::{remember, remembered},
        names_and_sides::NamesAndSides,
        page::Page,
        snapshot::Session,
        vehicle::geometry_of_page,
    },
    ui::reactive::{effect, memo},
};

/// A tab of the panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case", const_into_str)]
pub(super) enum ExperimentTab {
    Sequence,
    #[strum(serialize = "step-response")]
    Step,
    #[strum(serialize = "frequency-response")]
    Frequency,
    Characterise,
    Runs,
    Code,
}

impl ExperimentTab {
    pub(super) const ALL: &[Self] = Self::VARIANTS;

    pub(super) const fn key(self) -> &'static str {
        self.into_str()
    }
}

/// The key of the kept table in the browser's storage.
const REMEMBERED: &str = "experiments.sequence";
/// A longer table is not kept: it would be written whole at each change.
const REMEMBERED_ROWS_MAX: usize = 500;

/// The table of steps and what belongs to it, as typed.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Draft {
    pub(super) name: String,
    /// Speed, current and temperature; empty is no limit.
    pub(super) limits: [String; 3],
    pub(super) rows: Vec<Row>,
    pub(super) selected: usize,
}

impl Draft {
    pub(super) fn of(sequence: &Sequence) -> Self {
        let RunLimits { rpm, amps, celsius } = sequence.limits;
        let text = |limit: Option<f64>| limit.map(|limit| limit.to_string()).unwrap_or_default();
        Self {
            name: sequence.name.clone(),
            limits: [rpm, amps, celsius].map(text),
            rows: table::rows(sequence),
            selected: 0,
        }
    }

    /// The table of the last visit, or a template.
    fn first() -> Self {
        let last = remembered(REMEMBERED).and_then(|text| Sequence::from_json(&text).ok());
        Self::of(&last.unwrap_or_else(|| texts::of_template(Template::BackAndForth)))
    }

    /// Keeps the table for the next visit, if it is valid and not huge.
    fn remember(&self) {
        if self.rows.len() <= REMEMBERED_ROWS_MAX
            && let Ok(sequence) = self.sequence()
        {
            remember(REMEMBERED, &sequence.to_json());
        }
    }

    pub(super) fn sequence(&self) -> Result<Sequence, SequenceError> {
        Ok(Sequence {
            name: self.name.clone(),
            limits: table::limits(&self.limits)?,
            steps: table::steps(&self.rows)?,
        })
    }
}

/// The state of the run on the page.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Shown {
    /// Nothing is armed.
    #[default]
    Idle,
    /// The worker was asked to arm it.
    Asked,
    /// As the worker has reported it.
    Reported(RunState),
}

impl Shown {
    pub(super) fn phase(self) -> Option<Phase> {
        match self {
            Self::Reported(state) => Some(state.phase),
            Self::Idle | Self::Asked => None,
        }
    }

    /// Whether a run is armed, running or paused.
    pub(super) fn is_open(self) -> bool {
        self.is_driving() || matches!(self.phase(), Some(Phase::Armed { .. }))
    }

    /// Whether the run drives motors, also while it is paused.
    pub(super) fn is_driving(self) -> bool {
        matches!(self.phase(), Some(Phase::Running | Phase::Paused))
    }
}

/// What was armed last: the question, its plan, and the settings.
pub(super) struct Armed {
    pub(super) run: u32,
    pub(super) study: Study,
    pub(super) plan: Plan,
    pub(super) options: Options,
    /// The lower of the limits of the page and of the sequence.
    pub(super) limits: RunLimits,
    /// What the line carries of the rate.
    pub(super) carried: Option<CarriedRate>,
}

/// The panel: a pointer to its state, which stays through a change of language and while the panel is closed.
#[derive(Clone, Copy, Deref)]
pub(crate) struct Experiments(#[deref(forward)] &'static State);

/// The state of the panel.
pub(crate) struct State {
    pub(super) page: Page,
    pub(super) tab: RwSignal<ExperimentTab>,
    pub(super) draft: RwSignal<Draft>,
    /// The tables before the last changes; the newest last.
    pub(super) before: RwSignal<Vec<Draft>>,
    /// Rises when the rows of the table must be drawn again.
    pub(super) redrawn: RwSignal<u32>,
    /// The studies, one of each kind except for the sequence.
    pub(super) studies: RwSignal<Vec<Study>>,
    /// The study that the tab Characterise shows.
    pub(super) characterise: RwSignal<StudyKind>,
    /// Setpoints a second.
    pub(super) rate: RwSignal<u32>,
    pub(super) stop_on_lost_focus: RwSignal<bool>,
    pub(super) shown: RwSignal<Shown>,
    /// What the panel says about arming and starting, and about a file.
    pub(super) said: RwSignal<String>,
    /// When Pause was pressed last.
    pub(super) paused_ms: StoredValue<f64>,
    /// The names of the shown fields whose text is no number.
    pub(super) wrong_fields: RwSignal<Vec<&'static str>>,
    /// The number of the last run.
    pub(super) run: StoredValue<u32>,
    pub(super) armed: RwSignal<Option<Rc<Armed>>, LocalStorage>,
    /// The runs that the browser keeps.
    pub(super) kept: KeptRuns,
    /// The last run of each kind of study.
    pub(super) last: RwSignal<Vec<(StudyKind, u32)>>,
    /// The curves of the present run.
    pub(super) live: StoredValue<Live, LocalStorage>,
    /// Rises when the curves have changed.
    pub(super) live_drawn: RwSignal<u32>,
    pub(super) fleet: Memo<Fleet>,
    /// The measures of the rover.
    pub(super) geometry: RwSignal<Geometry>,
    /// Computed only when the question or the motors change: a long table takes a while.
    pub(super) checked: RwSignal<Checked>,
}

impl Experiments {
    /// Of this page: made at the first call, for the owner of the page.
    pub(crate) fn of_page(owner: &Owner, page: Page) -> Self {
        owner.with(|| {
            use_context().unwrap_or_else(|| {
                let motor = page.selected.get_untracked();
                let kinds = StudyKind::ALL.iter().copied();
                let studies = kinds
                    .filter(|kind| *kind != StudyKind::Sequence)
                    .map(|kind| Study::of(kind, motor));
                let new = Self(Box::leak(Box::new(State {
                    page,
                    tab: RwSignal::new(ExperimentTab::Sequence),
                    draft: RwSignal::new(Draft::first()),
                    before: RwSignal::new(Vec::new()),
                    redrawn: RwSignal::new(0),
                    studies: RwSignal::new(studies.collect()),
                    characterise: RwSignal::new(StudyKind::Friction),
                    rate: RwSignal::new(200),
                    stop_on_lost_focus: RwSignal::new(false),
                    paused_ms: StoredValue::new(f64::NEG_INFINITY),
                    wrong_fields: RwSignal::new(Vec::new()),
                    shown: RwSignal::default(),
                    said: RwSignal::default(),
                    run: StoredValue::new(0),
                    armed: RwSignal::new_local(None),
                    kept: KeptRuns::of_page(owner),
                    last: RwSignal::new(Vec::new()),
                    live: StoredValue::new_local(Live::default()),
                    live_drawn: RwSignal::new(0),
                    fleet: memo(move || fleet(page)),
                    geometry: geometry_of_page(owner, page),
                    checked: RwSignal::new(None),
                })));
                effect(move || new.checked.set(new.plan()));
                effect(move || new.draft.with(Draft::remember));
                new.listen();
                provide_context(new);
                new
            })
        })
    }

    /// The study that the open tab shows; none in the tabs Runs and Code.
    pub(super) fn kind(self) -> Option<StudyKind> {
        match self.tab.get() {
            ExperimentTab::Sequence => Some(StudyKind::Sequence),
            ExperimentTab::Step => Some(StudyKind::Step),
            ExperimentTab::Frequency => Some(StudyKind::Frequency),
            ExperimentTab::Characterise => Some(self.characterise.get()),
            ExperimentTab::Runs | ExperimentTab::Code => None,
        }
    }

    /// What is asked with the fields of the open tab.
    pub(super) fn study(self) -> Option<Result<Study, SequenceError>> {
        let kind = self.kind()?;
        if kind == StudyKind::Sequence {
            let sequence = self.draft.with(Draft::sequence);
            return Some(sequence.map(Study::Sequence));
        }
        self.studies.with(|studies| {
            let found = studies.iter().find(|study| study.kind() == kind);
            found.cloned().map(Ok)
        })
    }

    /// The last run of the study that the tab shows.
    pub(super) fn last_shown(self) -> Vec<u32> {
        let kind = self.kind();
        self.last.with(|last| {
            let of_kind = last.iter().filter(|(own, _)| Some(*own) == kind);
            of_kind.map(|(_, number)| *number).collect()
        })
    }

    fn plan(self) -> Checked {
        let study = self.study()?;
        Some(self.fleet.with(|fleet| {
            let study = study?;
            study.check(fleet)?;
            let plan = Plan::new(&study.sequence(), fleet)?;
            Ok((study, plan))
        }))
    }
}

/// What is asked, checked against the motors that are there; none in the tabs Runs and Code.
pub(super) type Checked = Option<Result<(Study, Plan), SequenceError>>;

/// The motors that have answered, with the group and the sides.
fn fleet(page: Page) -> Fleet {
    let names = page.motors.names;
    let motors = page.shown.with(Session::found);
    let group = names.with(NamesAndSides::group_members);
    let group = group.into_iter().map(|(id, _)| id).collect();
    let is_mirrored = |id| names.with(|names| names.mirror(id).is_mirrored());
    Fleet {
        mirrored: motors
            .iter()
            .copied()
            .filter(|id| is_mirrored(*id))
            .collect(),
        groups: vec![(GROUP.to_owned(), group)],
        rpm_max: page.model.get().spec().speed_rpm_max.into(),
        motors,
    }
}

/// The group of the panel `Drive together` in a sequence.
pub(super) const GROUP: &str = "together";
