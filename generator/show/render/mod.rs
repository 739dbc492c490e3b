//! Renders pictures whose specular highlights are bit-exact results of a device.
//!
//! The host is the software around the device. It computes visibility, normals, half vectors, and the ambient and diffuse light
//! in f64. An [`Engine`] computes the specular term of each sample for each light that falls on it, point by point or along lines
//! of points. A device that takes normals as operands, such as `shading`, also computes the ambient and diffuse light. A device
//! without colours computes the share of the light that is reflected.
//!
//! The same picture has the same bytes on every machine, because `libm` computes the transcendental functions. For a core
//! without mistakes, the bytes depend neither on the engine nor on the number of threads.

mod camera;
mod height;
mod mesh;
pub mod obj;
mod operands;
mod picture;
mod scene;
pub mod setup;
mod shade;
mod shapes;
mod vector;
mod visibility;

use anyhow::{Result, ensure};
use rayon::prelude::*;

pub use camera::View;
pub use height::Relief;
pub use mesh::{CREASE, Mesh};
pub use operands::{Feed, GivenOperand, Point, SceneCosine, SceneCosines, exponents, walks_lines};
pub use picture::{Picture, PictureDifference};
pub use scene::{BACKGROUND, BuiltIn, COLOUR, Light, Object, Scene, Shape};
pub use shade::{Material, point};
pub use vector::Vector;

use camera::Camera;
use glint_core::core::Core;
use glint_core::cosim::batch::{Engine, Points};
use glint_golden::{Contract, nearer};
use shade::{Shaded, Shader};
use visibility::{Raster, Visibility};

/// The largest width or height of a picture in pixels.
pub const LARGEST_SIDE: u32 = 8192;

/// The largest number of samples along each side of a pixel.
pub const MOST_SAMPLES: u32 = 8;

/// The largest number of samples of a picture: pixels times samples per pixel.
pub const LARGEST: u64 = 1 << 28;

pub const MOST_LIGHTS: usize = 16;

/// The default vertical field of view, in degrees.
pub const FIELD: f64 = 30.0;

/// The default exponent n. A device whose domain does not contain it gets the nearest exponent of its domain.
const EXPONENT: i64 = 80;

/// The approximate number of points that the engine gets at once, always for whole rows of pixels.
const PORTION: usize = 1 << 18;

#[derive(Clone, Debug)]
pub struct Settings {
    pub size: (u32, u32),
    /// The number of samples along each side of a pixel. The colour of the pixel is their mean.
    pub samples: u32,
    pub view: View,
    pub material: Material,
    /// The colour where no object is visible, from 0 to 1.
    pub background: Vector,
    /// Whether to render Blinn's function cosⁿγ in f64 as well, for comparison.
    pub compare: bool,
    /// The user's values for operands, among them all operands that a scene cannot supply by their names.
    pub operands: Vec<(String, GivenOperand)>,
}

#[derive(Clone, Debug)]
pub struct Rendered {
    pub picture: Picture,
    pub points: u64,
    /// The number of points with a roughness angle dγ (the normal's deviation) outside the device's domain. The renderer limited
    /// these angles to the domain.
    pub beyond: u64,
    pub comparison: Option<PictureComparison>,
}

impl Rendered {
    /// Returns the picture. With a comparison, returns the two pictures and their difference side by side, with captions.
    pub fn whole(&self, device: &str) -> Picture {
        let Some(comparison) = &self.comparison else {
            return self.picture.clone();
        };
        let difference = &comparison.difference;
        Picture::beside(&[
            &self.picture.captioned(device),
            &comparison.exact.captioned("Blinn in f64"),
            &difference.picture.captioned(&format!("difference × {}", difference.gain)),
        ])
    }
}

#[derive(Clone, Debug)]
pub struct PictureComparison {
    pub exact: Picture,
    /// The difference between the device's picture and this picture.
    pub difference: PictureDifference,
    /// The largest error of an output against the device's own formula, in output units.
    pub units: f64,
}

/// Returns 80, or the exponent of the device's domain that is nearest to 80.
pub fn usual_exponent(contract: &dyn Contract) -> u32 {
    let (least, most) = exponents(contract).unwrap_or((0, i64::MAX));
    EXPONENT.clamp(least, most).max(0) as u32
}

/// Returns whether Glint can compute all operands of the device from a scene.
pub fn draws(core: &Core) -> bool {
    let contract = core.contract.as_ref();
    Feed::new(core.device().name, contract).is_ok()
}

/// Checks the settings and the scene before rendering.
///
/// # Errors
///
/// Fails if the size, the number of samples or the number of lights is outside its limits. Fails if the picture has too many
/// samples in all. Fails if the scene has a height map and a mesh without texture coordinates.
pub fn check(settings: &Settings, scene: &Scene) -> Result<()> {
    let (width, height) = settings.size;
    let sides = 1..=LARGEST_SIDE;
    ensure!(
        sides.contains(&width) && sides.contains(&height),
        "a picture of {width}x{height} pixels: 1x1 to {LARGEST_SIDE}x{LARGEST_SIDE} are possible"
    );
    let samples = settings.samples;
    ensure!(
        (1..=MOST_SAMPLES).contains(&samples),
        "{samples} samples along a pixel: 1 to {MOST_SAMPLES} are possible"
    );
    let all = u64::from(width) * u64::from(height) * u64::from(samples) * u64::from(samples);
    ensure!(
        all <= LARGEST,
        "{width}x{height} pixels of {samples}x{samples} samples are {all} samples; at most {LARGEST} are possible"
    );
    let lights = scene.lights.len();
    ensure!(
        (1..=MOST_LIGHTS).contains(&lights),
        "there are {lights} lights; 1 to {MOST_LIGHTS} are possible"
    );
    if scene.relief.is_some() {
        for object in &scene.objects {
            ensure!(
                !matches!(&object.shape, Shape::Mesh(mesh) if !mesh.is_textured()),
                "a height map needs texture coordinates (`vt`) at every corner of the mesh"
            );
        }
    }
    Ok(())
}

/// Renders a scene with highlights that `engine` computes, for example the golden model or a simulation of the Verilog. Calls
/// `progress` with the number of finished rows of pixels, several times up to the picture's height.
///
/// # Errors
///
/// Fails if [`check`] does, if the camera is at the point at which it looks. Fails if a scene cannot supply an operand, or if the
/// engine fails. Fails if the scene has a height map and the device computes lines of points.
pub fn render(
    core: &Core,
    engine: &mut dyn Engine,
    scene: &Scene,
    settings: &Settings,
    progress: &mut dyn FnMut(u64),
) -> Result<Rendered> {
    check(settings, scene)?;
    let (width, height) = settings.size;
    let samples = settings.samples as usize;
    let (middle, radius) = scene.extent();
    let aspect = f64::from(width) / f64::from(height);
    let camera = Camera::new(&settings.view, aspect, middle, scene.balls())?;
    let contract = core.contract.as_ref();
    let feed = Feed::with(core.device().name, contract, &settings.operands)?;
    ensure!(
        feed.longest().is_none() || scene.relief.is_none(),
        "the device `{}` computes lines of points, and a height map cannot perturb lines",
        core.device().name
    );
    let raster = Raster::new(width as usize * samples, height as usize * samples, &camera);
    let visibility = Visibility::new(scene, &camera, raster, radius);
    let shader = Shader {
        scene,
        camera: &camera,
        material: settings.material,
        background: settings.background * 255.0,
        feed: &feed,
        compare: settings.compare,
    };
    let mut result = Portions {
        core,
        feed: &feed,
        engine,
        samples,
        width: width as usize,
        picture: Picture::new(width),
        exact: Picture::new(width),
        shown: Vec::new(),
        points: 0,
        beyond: 0,
        units: 0.0,
    };
    let line = raster.columns * samples * scene.lights.len();
    let rows_at_once = (PORTION / line).max(1);
    let mut row = 0;
    while row < height as usize {
        let end = (row + rows_at_once).min(height as usize);
        let (first, last) = (row * samples, end * samples);
        let hits = visibility.rows(first, last);
        let shaded: Vec<Shaded> = hits
            .par_chunks(raster.columns)
            .enumerate()
            .map(|(at, hits)| shader.shade(hits, |column| raster.ray(column, first + at)))
            .collect::<Result<_>>()?;
        result.add(&shaded, settings.compare)?;
        row = end;
        progress(row as u64);
    }
    Ok(result.finish(settings.compare))
}

/// A picture that grows row by row from the top, and the engine that computes its highlights.
struct Portions<'a> {
    core: &'a Core,
    feed: &'a Feed,
    engine: &'a mut dyn Engine,
    samples: usize,
    width: usize,
    picture: Picture,
    exact: Picture,
    /// Whether the device computed a highlight for at least one sample of each pixel. Filled only for a comparison.
    shown: Vec<bool>,
    points: u64,
    beyond: u64,
    units: f64,
}

impl Portions<'_> {
    /// Adds rows of pixels. The number of rows of samples must be a multiple of the number of samples along a pixel.
    fn add(&mut self, rows: &[Shaded], compare: bool) -> Result<()> {
        let mut points = Points::new(self.feed.operand_count());
        for row in rows {
            points.append(&row.points);
            self.beyond += row.beyond as u64;
        }
        self.points += points.len() as u64;
        let outputs = self.engine.compute(&points)?;
        let specular = self.specular(rows, &outputs);
        let device = self.pixels(rows, specular);
        self.picture.pixels.extend(device);
        if compare {
            self.units = self.units.max(self.error(&points, &outputs));
            let exact = rows.iter().flat_map(|row| row.exact.iter().copied());
            let exact = self.pixels(rows, exact.collect());
            self.exact.pixels.extend(exact);
            let samples = self.samples;
            let lines = rows.chunks(samples);
            let shown = lines.flat_map(|lines| {
                (0..self.width).map(move |pixel| {
                    let of = |row: &Shaded| {
                        let samples = &row.samples[pixel * samples..(pixel + 1) * samples];
                        samples.iter().any(|(_, lights)| *lights > 0)
                    };
                    lines.iter().any(of)
                })
            });
            self.shown.extend(shown);
        }
        Ok(())
    }

    /// Returns the specular light of every sample and light, 0 … 255 in each channel, from the device's results.
    fn specular(&self, rows: &[Shaded], outputs: &[i64]) -> Vec<Vector> {
        let width = self.core.contract.outputs().len();
        let result = |at: usize| &outputs[at * width..(at + 1) * width];
        let mut all = Vec::new();
        let mut first = 0;
        for row in rows {
            let count = row.points.result_count();
            match &row.places {
                None if self.feed.is_term() => {
                    let lights = row.lights.iter().enumerate();
                    all.extend(
                        lights.map(|(at, light)| self.feed.share_of(*light, result(first + at))),
                    );
                }
                None => {
                    all.extend((first..first + count).map(|at| self.feed.colour(|_| result(at))))
                }
                Some(places) => all.extend(
                    places
                        .iter()
                        .map(|places| self.feed.colour(|channel| result(first + places[channel]))),
                ),
            }
            first += count;
        }
        all
    }

    /// Returns the colours of pixels. A sample's colour is its ambient and diffuse light plus the `specular` light of each of its
    /// lights, limited to 255. The colour of a pixel is the mean of its samples.
    fn pixels(&self, rows: &[Shaded], specular: Vec<Vector>) -> Vec<[u8; 3]> {
        let mut sums = Vec::with_capacity(self.width * rows.len() / self.samples);
        let mut specular = specular.into_iter();
        let share = 1.0 / (self.samples * self.samples) as f64;
        for lines in rows.chunks(self.samples) {
            let mut line = vec![Vector::default(); self.width];
            for row in lines {
                for (at, (base, lights)) in row.samples.iter().enumerate() {
                    let mut colour = *base;
                    for light in specular.by_ref().take(*lights as usize) {
                        colour = colour + light;
                    }
                    let colour = Vector(colour.0.map(|value| value.min(255.0)));
                    let sum = &mut line[at / self.samples];
                    *sum = *sum + colour;
                }
            }
            sums.extend(line.into_iter().map(|sum| picture::pixel(sum * share)));
        }
        sums
    }

    /// Returns the largest error against the device's own formula, in output units.
    fn error(&self, points: &Points, outputs: &[i64]) -> f64 {
        let contract = self.core.contract.as_ref();
        let width = contract.outputs().len();
        let units: Vec<f64> = contract.outputs().iter().map(|it| it.format.to_f64(1)).collect();
        let errors = (0..points.len()).into_par_iter().map(|at| {
            let first = points.results_before(at);
            let (mut worst, mut exact) = (0.0f64, Vec::new());
            for index in 0..points.results(at) {
                exact.clear();
                contract.exact(points.operands(at), index as u64, &mut exact);
                let outputs = &outputs[(first + index) * width..];
                for ((&out, right), unit) in outputs.iter().zip(&exact).zip(&units) {
                    worst = worst.max(nearer(out as f64, right.map(|right| right / unit)));
                }
            }
            worst
        });
        errors.reduce(|| 0.0, f64::max)
    }

    fn finish(self, compare: bool) -> Rendered {
        let comparison = compare.then(|| PictureComparison {
            difference: PictureDifference::new(&self.picture, &self.exact, &self.shown),
            exact: self.exact,
            units: self.units,
        });
        Rendered { picture: self.picture, points: self.points, beyond: self.beyond, comparison }
    }
}
