//! Figures of a tally, over everything, by ring, and by class.

use occlabel_core::ClassId;
use serde::Serialize;

use super::figures::{Basis, Figures};
use super::share::Share;
use super::tally::{Counts, ObjectTally, Question, Tally};

/// How right labels are. Serializes with the names that `docs/quality.md` explains.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quality {
    /// How many keyframes were judged.
    pub keyframes: u64,
    /// Standard deviation of the logged ranges, metres.
    pub noise_sigma_m: f64,
    /// Over all rings and classes.
    pub all: Figures,
    /// By horizontal distance from the grid frame's origin.
    pub by_ring: Vec<RingQuality>,
    /// By class, in id order.
    pub by_class: Vec<ClassQuality>,
    /// The object of which the smallest share of seen voxels is labelled occupied.
    pub worst_object: Option<WorstObject>,
}

/// The figures of one range ring.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RingQuality {
    /// Inner radius, metres.
    pub from_m: f64,
    /// Outer radius, metres; none if it reaches to the end of the grid.
    pub to_m: Option<f64>,
    /// Its figures.
    pub figures: Figures,
}

/// The figures of one class.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClassQuality {
    /// The class's name.
    pub class: String,
    /// Those figures that say something of a single class.
    pub figures: Figures,
}

/// The least complete object.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WorstObject {
    /// Its scene.
    pub scene: String,
    /// Its number in the truth of that scene.
    pub track: u16,
    /// Its class.
    pub class: Option<String>,
    /// Of its voxels that some ray ended in, the share labelled occupied.
    pub completeness: f64,
    /// How many such voxels there are, over all keyframes.
    pub voxels: u64,
}

impl Tally {
    /// Takes the ratios.
    pub fn quality(&self) -> Quality {
        Quality {
            keyframes: self.keyframes,
            noise_sigma_m: self.noise_sigma_m,
            all: Figures::of(&self.all()),
            by_ring: (0..self.rings.len()).map(|ring| self.ring_quality(ring)).collect(),
            by_class: (0..self.classes.len()).map(|class| self.class_quality(class)).collect(),
            worst_object: self.worst_object(),
        }
    }

    fn ring_quality(&self, ring: usize) -> RingQuality {
        let basis = Basis {
            counts: sum(self.rings[ring].by_class()),
            accuracies: self.accuracies(|class| accuracy(&self.rings[ring].by_class()[class])),
            objects: self.objects.values().map(|object| object.rings[ring]).collect(),
        };
        RingQuality {
            from_m: ring.checked_sub(1).map_or(0.0, |inner| self.ring_m[inner]),
            to_m: self.ring_m.get(ring).copied(),
            figures: Figures::of(&basis),
        }
    }

    fn class_quality(&self, class: usize) -> ClassQuality {
        let is_of_it = |object: &&ObjectTally| object.class.map(ClassId::index) == Some(class);
        let basis = Basis {
            counts: self.counts_of(class),
            accuracies: vec![],
            objects: self.objects.values().filter(is_of_it).map(ObjectTally::all).collect(),
        };
        ClassQuality { class: self.classes[class].clone(), figures: Figures::of_class(&basis) }
    }

    fn all(&self) -> Basis {
        Basis {
            counts: sum(self.rings.iter().flat_map(|ring| ring.by_class())),
            accuracies: self.accuracies(|class| accuracy(&self.counts_of(class))),
            objects: self.objects.values().map(ObjectTally::all).collect(),
        }
    }

    fn counts_of(&self, class: usize) -> Counts {
        sum(self.rings.iter().map(|ring| &ring.by_class()[class]))
    }

    fn accuracies(&self, of: impl Fn(usize) -> Share) -> Vec<Share> {
        (0..self.classes.len()).map(of).collect()
    }

    /// The first of its kind, by scene and track, if several are equally incomplete.
    fn worst_object(&self) -> Option<WorstObject> {
        let ratios = self.objects.iter().filter_map(|(key, object)| {
            let share = object.all();
            Some((key, object.class, share.ratio()?, share.of))
        });
        let worst = ratios.reduce(|worst, next| if next.2 < worst.2 { next } else { worst });
        worst.map(|((scene, track), class, completeness, voxels)| WorstObject {
            scene: scene.clone(),
            track: *track,
            class: class.map(|class| self.classes[class.index()].clone()),
            completeness,
            voxels,
        })
    }
}

fn sum<'a>(counts: impl IntoIterator<Item = &'a Counts>) -> Counts {
    let mut sum = Counts::default();
    counts.into_iter().for_each(|counts| sum.add(counts));
    sum
}

fn accuracy(counts: &Counts) -> Share {
    counts.share(Question::ClassAccuracy)
}
