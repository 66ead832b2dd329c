//! How far apart colours look, to readers with and without the sense of red, green and blue.

/// From linear red, green and blue to what is seen of them without the sense of red, of green, of
/// blue (Machado, Oliveira & Fernandes 2009, severity 1).
const DEFICIENCIES: [[[f64; 3]; 3]; 3] = [
    [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
];

/// The distance of two colours in OKLab (Ottosson 2020), thousandths: the least that a reader of full
/// sight or of any of the deficiencies sees. Black and white are 1000 apart.
pub(super) fn apart(a: [u8; 3], b: [u8; 3]) -> u32 {
    let [a, b] = [a, b].map(|color| color.map(linear));
    let seen = |matrix: &[[f64; 3]; 3]| {
        let [a, b] = [a, b].map(|color| times(matrix, color).map(|light| light.clamp(0.0, 1.0)));
        distance(oklab(a), oklab(b))
    };
    let deficient = DEFICIENCIES.iter().map(seen);
    let least = deficient.fold(distance(oklab(a), oklab(b)), f64::min);
    (least * 1000.0) as u32
}

/// The light of an sRGB channel, 0 to 1.
fn linear(channel: u8) -> f64 {
    let share = f64::from(channel) / 255.0;
    match share <= 0.04045 {
        true => share / 12.92,
        false => libm::pow((share + 0.055) / 1.055, 2.4),
    }
}

/// Linear red, green and blue in OKLab: lightness, green to red, blue to yellow.
fn oklab(rgb: [f64; 3]) -> [f64; 3] {
    const CONES: [[f64; 3]; 3] = [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ];
    const OPPONENTS: [[f64; 3]; 3] = [
        [0.2104542553, 0.7936177850, -0.0040720468],
        [1.9779984951, -2.4285922050, 0.4505937099],
        [0.0259040371, 0.7827717662, -0.8086757660],
    ];
    times(&OPPONENTS, times(&CONES, rgb).map(libm::cbrt))
}

fn times(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn greys_look_the_same_to_all_and_differ_by_lightness_alone() {
        assert_eq!(apart([0; 3], [255; 3]), 999, "the published digits are not quite 1");
        assert_eq!(apart([90; 3], [90; 3]), 0);
        for matrix in DEFICIENCIES {
            let grey = times(&matrix, [0.5; 3]);
            assert!(grey.iter().all(|light| (light - 0.5).abs() < 1e-5), "{grey:?}");
        }
    }

    #[test]
    fn oklab_of_the_primaries_is_as_published() {
        let close = |rgb: [f64; 3], lab: [f64; 3]| assert!(distance(oklab(rgb), lab) < 1e-3);
        close([1.0, 0.0, 0.0], [0.628, 0.225, 0.126]);
        close([0.0, 1.0, 0.0], [0.866, -0.234, 0.179]);
        close([0.0, 0.0, 1.0], [0.452, -0.032, -0.312]);
    }

    /// A red and a green of one brightness: far apart to most, the same without the sense of either.
    #[test]
    fn who_lacks_a_sense_takes_its_colors_for_one() {
        let (red, green) = ([196, 78, 58], [98, 112, 40]);
        let [a, b] = [red, green].map(|color| oklab(color.map(linear)));
        assert!(distance(a, b) > 0.15);
        assert!(apart(red, green) < 75, "{}", apart(red, green));
    }
}
