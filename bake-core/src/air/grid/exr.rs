//! OpenEXR: slices side by side in one image, pixel x = i + nx·k, y = j, as packages store probes.

use super::{Choice, GridFault, Lattice, checked_points};
use exr::prelude::*;
use std::io::Cursor;

const FORMAT: &str = "OpenEXR";

/// Reads one channel of the first layer.
pub fn read(bytes: &[u8], choice: Choice) -> std::result::Result<Lattice, GridFault> {
    let damaged = |error: Error| GridFault::damaged(FORMAT, error);
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), true).map_err(damaged)?;
    for header in &meta.headers {
        let (width, height) = (header.layer_size.width() as u64, header.layer_size.height() as u64);
        let channels = header.channels.list.len() as u64;
        checked_points([side(width)?, side(height)?, side(channels)?], bytes.len())?;
    }
    let image = read_image(bytes).map_err(damaged)?;
    let channels = &image.layer_data.channel_data.list;
    let names: Vec<String> = channels.iter().map(|channel| channel.name.to_string()).collect();
    let index = match choice.name {
        Some(name) => names.iter().position(|known| known == name),
        None if names.len() == 1 => Some(0),
        None => return Err(GridFault::Several { what: "channel", names }),
    };
    let Some(index) = index else {
        return Err(GridFault::NoSuch { what: "channel", name: choice.name.unwrap_or_default().into(), names });
    };
    let values: Vec<f32> = channels[index].sample_data.values_as_f32().collect();
    let [width, height] = [image.layer_data.size.width(), image.layer_data.size.height()];
    unfold(&values, width, height, choice.size)
}

fn side(count: u64) -> std::result::Result<u32, GridFault> {
    u32::try_from(count).map_err(|_| GridFault::damaged(FORMAT, format!("a side of {count}")))
}

fn read_image(bytes: &[u8]) -> Result<Image<Layer<AnyChannels<FlatSamples>>>> {
    exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
}

/// Puts slices behind each other. Without a size the image is one slice.
fn unfold(
    values: &[f32],
    width: usize,
    height: usize,
    size: Option<[u32; 3]>,
) -> std::result::Result<Lattice, GridFault> {
    let size = size.unwrap_or([width as u32, height as u32, 1]);
    let [nx, ny, nz] = size.map(|side| side as usize);
    if nx.checked_mul(nz) != Some(width) || ny != height {
        let expected = size.iter().map(|&side| u64::from(side)).product();
        return Err(GridFault::Size { found: values.len() as u64, unit: "texels", expected });
    }
    let row = |j: usize, k: usize| &values[j * width + k * nx..][..nx];
    let slices = (0..nz).flat_map(|k| (0..ny).flat_map(move |j| row(j, k)));
    Ok(Lattice { size, values: slices.copied().collect(), world_from_grid: None })
}
