//! What was counted, before any ratio is taken.

use std::collections::BTreeMap;
use std::iter::Sum;
use std::ops::AddAssign;

use occlabel_core::ClassId;

use super::histogram::Histogram;
use super::scale::Scale;
use super::share::Share;

/// A question with a yes or a no for each voxel that it is put to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Question {
    OccupiedPrecision,
    OccupiedPrecisionNoise,
    ClassAccuracy,
    ClassPresent,
    ClassHit,
    SurfaceRecall,
    SurfaceRecallDense,
    FreePurity,
    FreePurityStrict,
    FreeRecall,
    TrailRate,
    MaskLidar,
    MaskCamera,
    MaskCameraSight,
    OccupiedCamera,
    FlowMissing,
    StaticFlow,
    People,
}

/// A size that is measured at each voxel that it is asked of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Size {
    OccupiedDistance,
    SurfaceDistance,
    FlowError,
    FlowErrorRightClass,
    PeopleSpeedError,
}

const QUESTIONS: usize = Question::People as usize + 1;
const SIZES: usize = Size::PeopleSpeedError as usize + 1;

/// The counts of one ring and class.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    shares: [Share; QUESTIONS],
    sizes: [Histogram; SIZES],
}

impl Counts {
    pub(crate) fn share(&self, question: Question) -> Share {
        self.shares[question as usize]
    }

    pub(crate) fn size(&self, size: Size) -> &Histogram {
        &self.sizes[size as usize]
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.shares.iter_mut().zip(other.shares).for_each(|(sum, share)| *sum += share);
        self.sizes.iter_mut().zip(&other.sizes).for_each(|(sum, sizes)| sum.add(sizes));
    }
}

/// The counts of one ring: one for each class, and a last one for voxels without a class.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Ring(Vec<Counts>);

impl Ring {
    pub(crate) fn new(classes: usize) -> Self {
        Self(vec![Counts::default(); classes + 1])
    }

    /// Notes the answer at one voxel, under the class that the question asks by.
    #[inline]
    pub(crate) fn count(&mut self, question: Question, class: Option<ClassId>, is_so: bool) {
        self.under(class).shares[question as usize].count(is_so);
    }

    /// Notes the overlap of two masks at one voxel.
    #[inline]
    pub(crate) fn overlap(&mut self, question: Question, one: bool, other: bool) {
        if one || other {
            self.count(question, None, one && other);
        }
    }

    /// Notes a size measured at one voxel.
    #[inline]
    pub(crate) fn measure(&mut self, size: Size, class: Option<ClassId>, measured: f64) {
        self.under(class).sizes[size as usize].insert(measured);
    }

    #[inline]
    fn under(&mut self, class: Option<ClassId>) -> &mut Counts {
        let none = self.0.len() - 1;
        &mut self.0[class.map_or(none, ClassId::index)]
    }

    pub(crate) fn by_class(&self) -> &[Counts] {
        &self.0
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.0.iter_mut().zip(&other.0).for_each(|(sum, counts)| sum.add(counts));
    }
}

/// A mover of a scene, and how much of what was seen of it is labelled.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ObjectTally {
    /// Its class; the lowest id if its parts differ; none if none has a class.
    pub(crate) class: Option<ClassId>,
    /// The seen voxels that are labelled occupied, by ring.
    pub(crate) rings: Vec<Share>,
}

impl ObjectTally {
    pub(crate) fn add(&mut self, other: &Self) {
        self.class = self.class.into_iter().chain(other.class).min();
        self.rings.iter_mut().zip(&other.rings).for_each(|(sum, share)| *sum += *share);
    }

    /// Over all rings.
    pub(crate) fn all(&self) -> Share {
        let mut all = Share::default();
        self.rings.iter().for_each(|share| all += *share);
        all
    }
}

/// What was counted over some keyframes, in integers: tallies of keyframes and scenes add up to the
/// same sum in any order. [`Tally::quality`] takes the ratios.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    pub(crate) keyframes: u64,
    pub(crate) classes: Vec<String>,
    pub(crate) ring_m: Vec<f64>,
    pub(crate) noise_sigma_m: f64,
    pub(crate) rings: Vec<Ring>,
    pub(crate) objects: BTreeMap<(String, u16), ObjectTally>,
}

impl Tally {
    /// The counts of one keyframe.
    pub(crate) fn of_keyframe(
        scale: &Scale,
        rings: Vec<Ring>,
        objects: BTreeMap<(String, u16), ObjectTally>,
    ) -> Self {
        Self {
            keyframes: 1,
            classes: scale.classes.clone(),
            ring_m: scale.ring_m.clone(),
            noise_sigma_m: scale.noise_sigma_m,
            rings,
            objects,
        }
    }

    fn is_of_one_scale(&self, other: &Self) -> bool {
        self.classes == other.classes
            && self.ring_m == other.ring_m
            && self.noise_sigma_m == other.noise_sigma_m
    }
}

impl AddAssign for Tally {
    /// # Panics
    /// If classes, rings or noise differ. An empty tally fits every other.
    fn add_assign(&mut self, other: Self) {
        if other.keyframes == 0 {
            return;
        }
        if self.keyframes == 0 {
            *self = other;
            return;
        }
        assert!(self.is_of_one_scale(&other), "tallies of one scale");
        self.keyframes += other.keyframes;
        self.rings.iter_mut().zip(&other.rings).for_each(|(sum, ring)| sum.add(ring));
        for (key, object) in other.objects {
            self.objects.entry(key).and_modify(|sum| sum.add(&object)).or_insert(object);
        }
    }
}

impl Sum for Tally {
    fn sum<I: Iterator<Item = Self>>(tallies: I) -> Self {
        tallies.fold(Self::default(), |mut sum, tally| {
            sum += tally;
            sum
        })
    }
}
