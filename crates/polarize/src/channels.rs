//! Four images of one moment.

/// Intensities behind polarizers at 0, 45, 90 and 135 degrees: of each as many pixels, in one order.
#[derive(Clone, Copy, Debug)]
pub struct Channels<'a>([&'a [u16]; 4]);

impl<'a> Channels<'a> {
    /// Four images; none if they have not all as many pixels.
    pub fn new(channels: [&'a [u16]; 4]) -> Option<Self> {
        let pixels = channels[0].len();
        channels.iter().all(|channel| channel.len() == pixels).then_some(Self(channels))
    }

    /// The four intensities of each pixel.
    pub fn pixels(&self) -> impl Iterator<Item = [f64; 4]> {
        let channels = self.0;
        (0..channels[0].len()).map(move |at| channels.map(|channel| f64::from(channel[at])))
    }
}
