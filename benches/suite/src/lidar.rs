//! The lidar pass on each instruction set of this processor, beside the scalar walk.

use occlabel_annotate::relabel;
use occlabel_core::{Instant, Level};
use occlabel_pipeline::Rules;
use occlabel_raycast::{Casting, Crossings, count};

use crate::args::Args;
use crate::clock::cost_of;
use crate::keyframe::{instant, visits, walk_background};
use crate::row::{Case, measure, print};
use crate::stages::{one_thread, some_keyframes, sorted};
use crate::world::OpenLog;

/// What is kept of the crossings, and what the kernel is called for it.
const KERNELS: [(&str, Crossings); 2] =
    [("marks", Crossings::Whether), ("counts", Crossings::HowMany)];

/// Some rays into the grids of a few keyframes, by the rules of `precise`.
struct Pass<'a> {
    name: &'static str,
    rules: &'a Rules,
    instants: [Instant<'a>; 3],
    rays: u64,
    visits: u64,
}

pub(crate) fn run(args: &Args) {
    one_thread();
    let log = OpenLog::open(&args.world, &[]);
    let rules = log.rules("precise");
    let aggregated = relabel(sorted(&log, &rules), &rules.relabel(&log.scene));
    let instants = || {
        let keyframes = some_keyframes(&log.scene);
        keyframes.map(|keyframe| instant(&log.scene, &aggregated, keyframe, &rules))
    };
    let background = Pass::new("background", &rules, instants().map(alone));
    let all = Pass::new("all rays", &rules, instants());
    background.check();
    let mut cases = vec![background.scalar()];
    cases.extend(background.kernels());
    cases.extend(all.kernels());
    print(&measure("lidar", cases, args.rounds));
}

/// The background alone, as if there were no tracks.
fn alone(mut instant: Instant) -> Instant {
    instant.objects.clear();
    instant.standing.clear();
    instant
}

impl<'a> Pass<'a> {
    fn new(name: &'static str, rules: &'a Rules, mut instants: [Instant<'a>; 3]) -> Self {
        let visits = instants.iter_mut().map(|instant| visits_of(instant, rules)).sum();
        let rays = instants.iter().map(Instant::ray_count).sum();
        Self { name, rules, instants, rays, visits }
    }

    /// That the walk and the kernels do the same work.
    fn check(&self) {
        let (Rules { spec, .. }, casting) = (self.rules, Casting::new(Crossings::HowMany, 1));
        for instant in &self.instants {
            let counts = count(instant, spec, &self.rules.rays(), &casting);
            assert!(walk_background(instant, spec) == counts, "the kernel differs from the walk");
        }
    }

    /// The walk of one ray after the other.
    fn scalar(&self) -> Case<'_> {
        let spec = &self.rules.spec;
        self.case("scalar walk", |instant| drop(walk_background(instant, spec)))
    }

    /// Every kernel on every instruction set.
    fn kernels(&self) -> Vec<Case<'_>> {
        let case = |(kernel, crossings), level| {
            let casting = Casting { level, ..Casting::new(crossings, 1) };
            let Rules { spec, .. } = self.rules;
            self.case(&format!("{kernel}, {level:?}").to_lowercase(), move |instant| {
                drop(count(instant, spec, &self.rules.rays(), &casting));
            })
        };
        let levels = |kernel| Level::all().into_iter().map(move |level| case(kernel, level));
        KERNELS.into_iter().flat_map(levels).collect()
    }

    fn case(&self, how: &str, cast: impl Fn(&Instant) + 'a) -> Case<'_> {
        let name = format!("{}, {how}", self.name);
        let all = move || cost_of(|| self.instants.iter().for_each(&cast));
        Case::new(name, "ray", self.rays, all).and("voxel visit", self.visits)
    }
}

/// How many voxels are walked through.
fn visits_of(instant: &mut Instant, rules: &Rules) -> u64 {
    // Crossings in the boxes of tracks that stand are counted and then forgotten.
    let standing = std::mem::take(&mut instant.standing);
    let casting = Casting::new(Crossings::HowMany, 1);
    let counts = count(instant, &rules.spec, &rules.rays(), &casting);
    instant.standing = standing;
    visits(&counts)
}
