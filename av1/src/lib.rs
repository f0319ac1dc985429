//! AV1 from pictures of luma and chroma: `rav1e` for 8 bits, 4:2:0, BT.709 in limited range.
//!
//! This is a crate of its own for the sake of compile times: the encoder is generic, and would
//! otherwise be compiled again with every change of the engine.

use rav1e::color::{ChromaSamplePosition, ChromaSampling, ColorDescription, ColorPrimaries};
use rav1e::color::{MatrixCoefficients, PixelRange, TransferCharacteristics};
use rav1e::data::Rational;
use rav1e::prelude::SceneDetectionSpeed;
use rav1e::{Config, Context, EncoderConfig, EncoderStatus, InvalidConfig};

/// Speed preset of the encoder, 0 to 10 (fastest). `docs/ALGORITHM.md`, *Films*, has what it was
/// chosen by.
const SPEED: u8 = 9;

/// Settings of an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Av1Settings {
    /// Width and height in pixels, both even.
    pub size: [u32; 2],
    /// Frames per second.
    pub rate: u32,
    /// Quantizer, 0 (finest) to 255, the same for all frames.
    pub quantizer: u8,
    /// Level of AV1 that is promised to decoders, 0 to 23, or 31 for none.
    pub level: u8,
    /// Maximum number of frames that are given to the encoder. The first is a key frame, the others
    /// are not.
    pub frames: u32,
}

/// Frames cannot be encoded.
#[derive(Clone, Debug, thiserror::Error)]
pub enum Av1Error {
    /// The encoder does not accept the settings.
    #[error(transparent)]
    Settings(#[from] InvalidConfig),
    /// The encoder has failed.
    #[error("the encoder has failed: {0}")]
    Encoder(#[from] EncoderStatus),
}

/// An encoder, which works on the thread that calls it.
pub struct Av1Encoder {
    context: Context<u8>,
    width: usize,
}

impl Av1Encoder {
    /// Creates an encoder.
    ///
    /// # Errors
    /// [`Av1Error::Settings`] if it does not accept the settings.
    pub fn new(settings: &Av1Settings) -> Result<Self, Av1Error> {
        let config = Config::new().with_encoder_config(config(settings)).with_threads(1);
        Ok(Self { context: config.new_context()?, width: settings.size[0] as usize })
    }

    /// Adds a frame as planes of luma, blue and red, row-major from the top, and returns the coded
    /// frames that are complete: temporal units in the order of display. They come late, because a
    /// frame is coded with those after it.
    ///
    /// # Errors
    /// [`Av1Error::Encoder`] if it has failed.
    pub fn encode(&mut self, planes: [&[u8]; 3]) -> Result<Vec<Vec<u8>>, Av1Error> {
        let mut frame = self.context.new_frame();
        let strides = [self.width, self.width / 2, self.width / 2];
        for (plane, (samples, stride)) in frame.planes.iter_mut().zip(planes.into_iter().zip(strides)) {
            plane.copy_from_raw_u8(samples, stride, 1);
        }
        self.context.send_frame(frame)?;
        self.receive()
    }

    /// Returns the coded frames that are left.
    ///
    /// # Errors
    /// [`Av1Error::Encoder`] if it has failed.
    pub fn finish(mut self) -> Result<Vec<Vec<u8>>, Av1Error> {
        self.context.flush();
        self.receive()
    }

    fn receive(&mut self) -> Result<Vec<Vec<u8>>, Av1Error> {
        let mut coded = Vec::new();
        loop {
            match self.context.receive_packet() {
                Ok(packet) => coded.push(packet.data),
                Err(EncoderStatus::Encoded) => {}
                Err(EncoderStatus::NeedMoreData | EncoderStatus::LimitReached) => return Ok(coded),
                Err(error) => return Err(error.into()),
            }
        }
    }
}

fn config(settings: &Av1Settings) -> EncoderConfig {
    let mut config = EncoderConfig::with_speed_preset(SPEED);
    [config.width, config.height] = settings.size.map(|side| side as usize);
    config.time_base = Rational::new(1, settings.rate.into());
    config.chroma_sampling = ChromaSampling::Cs420;
    config.chroma_sample_position = ChromaSamplePosition::Vertical;
    config.pixel_range = PixelRange::Limited;
    config.color_description = Some(ColorDescription {
        color_primaries: ColorPrimaries::BT709,
        transfer_characteristics: TransferCharacteristics::BT709,
        matrix_coefficients: MatrixCoefficients::BT709,
    });
    config.level_idx = Some(settings.level);
    config.quantizer = settings.quantizer.into();
    config.min_key_frame_interval = settings.frames.into();
    config.max_key_frame_interval = settings.frames.into();
    config.speed_settings.scene_detection_mode = SceneDetectionSpeed::None;
    config.tiles = 1;
    config
}
