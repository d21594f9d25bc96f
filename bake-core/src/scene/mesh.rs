//! Meshes: gathers the vertices that triangles use, checks every number, fills in what is absent.

use super::accessor::View;
use super::document::MeshRecord;
use super::error::{Fault, Place, Refusal, lookup};
use super::primitive::{Reader, Source};
use super::warning::{WarningKind, Warnings};
use super::{Mesh, Primitive};
use glam::{DVec3, Vec2, Vec3, Vec4};

/// Triangles whose doubled area is below this share of their longest edge squared have no usable normal: f32 positions
/// carry relative errors of 6e-8, squared here.
const FLAT: f64 = 1e-14;

/// The coordinate sets that are read.
const TEXCOORDS: [&str; 3] = ["TEXCOORD_0", "TEXCOORD_1", "TEXCOORD_2"];

/// Loads a mesh; none when it has no triangle.
pub(super) fn load(
    source: &Source,
    index: usize,
    record: &MeshRecord,
    warnings: &mut Warnings,
) -> Result<Option<Mesh>, Refusal> {
    let name = record.name.clone().unwrap_or_else(|| format!("mesh {index}"));
    let mut mesh = Mesh { name, has_texcoord_1: true, ..Mesh::default() };
    let at = Place::entry("meshes", index);
    for (i, primitive) in record.primitives.iter().enumerate() {
        let place = at.item("primitives", i);
        let material = material(source, primitive.material, &place)?;
        if primitive.targets.is_some() {
            warnings.push(
                WarningKind::Deformation,
                &place,
                "morph targets are not applied: the mesh bakes in its base shape",
            );
        }
        if primitive.mode.is_some_and(|mode| mode < 4) {
            warnings.push(WarningKind::PointsOrLines, &place, "points and lines are not baked");
        } else {
            let reader = Reader::new(source, primitive, place)?;
            append(&mut mesh, &reader, material, &place, warnings)?;
        }
    }
    Ok(if mesh.triangles.is_empty() { None } else { Some(mesh) })
}

/// Index of a material; the default material follows those of the document.
fn material(source: &Source, index: Option<u32>, place: &Place) -> Result<u32, Refusal> {
    let materials = &source.document.materials;
    let Some(index) = index else { return Ok(materials.len() as u32) };
    lookup(materials, "materials", index, &place.field("material")).map(|_| index)
}

/// The attributes of one primitive.
struct Attributes<'a> {
    positions: View<'a>,
    normals: Option<View<'a>>,
    texcoords: [Option<View<'a>>; 3],
    colors: Option<View<'a>>,
}

fn append(
    mesh: &mut Mesh,
    reader: &Reader,
    material: u32,
    place: &Place,
    warnings: &mut Warnings,
) -> Result<(), Refusal> {
    let Some(attributes) = attributes(reader, place)? else {
        warnings.push(WarningKind::EmptyPrimitive, place, "the primitive has no POSITION and is left out");
        return Ok(());
    };
    let mut triangles = reader.triangles(attributes.positions.count)?;
    let before = triangles.len();
    drop_degenerate(&mut triangles, &attributes.positions, place)?;
    let dropped = (before - triangles.len()) as u64;
    warnings.push_many(WarningKind::DegenerateTriangles, place, dropped, "triangles without area are left out");
    if triangles.is_empty() {
        warnings.push(WarningKind::EmptyPrimitive, place, "the primitive has no triangles and is left out");
        return Ok(());
    }
    let used = if attributes.normals.is_some() { compact(&mut triangles) } else { unshare(&mut triangles) };
    let (first_vertex, first_triangle) = (mesh.positions.len() as u32, mesh.triangles.len() as u32);
    let checked = Gather { used: &used, place };
    mesh.positions.extend(checked.vectors::<3>(&attributes.positions, "POSITION")?.into_iter().map(Vec3::from));
    for (set, view) in attributes.texcoords.iter().enumerate() {
        let name = TEXCOORDS[set];
        mesh.texcoords[set].extend(checked.optional::<2>(view.as_ref(), name, 0.0)?.into_iter().map(Vec2::from));
    }
    mesh.has_texcoord_1 &= attributes.texcoords[1].is_some();
    mesh.colors.extend(colors(&checked, attributes.colors.as_ref(), warnings)?);
    let positions = &mesh.positions[first_vertex as usize..];
    mesh.normals.extend(normals(&checked, attributes.normals.as_ref(), &triangles, positions, warnings)?);
    mesh.triangles.extend(triangles.iter().map(|t| t.map(|v| v + first_vertex)));
    mesh.primitives.push(Primitive {
        triangles: first_triangle..mesh.triangles.len() as u32,
        vertices: first_vertex..mesh.positions.len() as u32,
        material,
    });
    Ok(())
}

/// Opens all attributes and checks that they have equal counts; none without positions.
fn attributes<'a>(reader: &'a Reader, place: &Place) -> Result<Option<Attributes<'a>>, Refusal> {
    let Some(positions) = reader.attribute("POSITION", &[3])? else { return Ok(None) };
    let count = positions.count;
    let open = |name: &str, widths: &[usize]| match reader.attribute(name, widths)? {
        Some(view) if view.count != count => {
            let list = place.field("attributes");
            Err(Fault::value(format!("{} elements long", view.count), format!("{count} as POSITION"))
                .at(&list.field(name)))
        }
        view => Ok(view),
    };
    let [a, b, c] = TEXCOORDS.map(|name| open(name, &[2]));
    let texcoords = [a?, b?, c?];
    Ok(Some(Attributes { positions, normals: open("NORMAL", &[3])?, texcoords, colors: open("COLOR_0", &[3, 4])? }))
}

/// Drops triangles without area; refuses positions that are no numbers.
fn drop_degenerate(triangles: &mut Vec<[u32; 3]>, positions: &View, place: &Place) -> Result<(), Refusal> {
    let mut bad = None;
    triangles.retain(|triangle| {
        let corner = |i: usize| Vec3::from(positions.floats::<3>(triangle[i].into())).as_dvec3();
        let corners = [corner(0), corner(1), corner(2)];
        if let Some(i) = corners.iter().position(|p| !p.is_finite()) {
            bad.get_or_insert((triangle[i], corners[i]));
        }
        !is_flat(corners)
    });
    let list = place.field("attributes");
    let refuse = |(vertex, value)| Err(not_finite(vertex, format!("{value}")).at(&list.field("POSITION")));
    bad.map_or(Ok(()), refuse)
}

fn is_flat([a, b, c]: [DVec3; 3]) -> bool {
    let longest = (b - a).length_squared().max((c - a).length_squared()).max((c - b).length_squared());
    let doubled_area = (b - a).cross(c - a).length();
    // The second test is for triangles whose area is no normal f32 number.
    doubled_area <= FLAT * longest || doubled_area < f64::from(f32::MIN_POSITIVE)
}

fn not_finite(vertex: u32, value: String) -> Fault {
    Fault::value(format!("{value} at vertex {vertex}"), "finite numbers")
}

/// Renumbers the corners so that only used vertices remain, in their old order; returns the old numbers.
fn compact(triangles: &mut [[u32; 3]]) -> Vec<u32> {
    let mut used: Vec<u32> = triangles.as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    for corner in triangles.as_flattened_mut() {
        *corner = used.binary_search(corner).expect("every corner was collected") as u32;
    }
    used
}

/// Gives every corner a vertex of its own, so that flat normals do not meet at shared ones; returns the old numbers.
fn unshare(triangles: &mut [[u32; 3]]) -> Vec<u32> {
    let used = triangles.as_flattened().to_vec();
    for (i, corner) in triangles.as_flattened_mut().iter_mut().enumerate() {
        *corner = i as u32;
    }
    used
}

/// Reads attributes of the used vertices.
struct Gather<'a> {
    used: &'a [u32],
    place: &'a Place<'a>,
}

impl Gather<'_> {
    fn vectors<const N: usize>(&self, view: &View, name: &str) -> Result<Vec<[f32; N]>, Refusal> {
        let read = |&vertex: &u32| {
            let value = view.floats::<N>(vertex.into());
            if value.iter().all(|x| x.is_finite()) {
                return Ok(value);
            }
            Err(not_finite(vertex, format!("{value:?}")).at(&self.place.field("attributes").field(name)))
        };
        self.used.iter().map(read).collect()
    }

    fn optional<const N: usize>(
        &self,
        view: Option<&View>,
        name: &str,
        default: f32,
    ) -> Result<Vec<[f32; N]>, Refusal> {
        view.map_or_else(|| Ok(vec![[default; N]; self.used.len()]), |view| self.vectors(view, name))
    }
}

/// Vertex colours in [0, 1]; white where absent.
fn colors(gather: &Gather, view: Option<&View>, warnings: &mut Warnings) -> Result<Vec<Vec4>, Refusal> {
    let colors: Vec<Vec4> = match view {
        Some(view) if view.width == 3 => {
            gather.vectors::<3>(view, "COLOR_0")?.into_iter().map(|c| Vec3::from(c).extend(1.0)).collect()
        }
        view => gather.optional::<4>(view, "COLOR_0", 1.0)?.into_iter().map(Vec4::from).collect(),
    };
    let clamped: Vec<Vec4> = colors.iter().map(|c| c.clamp(Vec4::ZERO, Vec4::ONE)).collect();
    let changed = clamped.iter().zip(&colors).filter(|(a, b)| a != b).count() as u64;
    warnings.push_many(WarningKind::ColorRange, gather.place, changed, "vertex colours outside 0 to 1 are clamped");
    Ok(clamped)
}

/// Unit normals; the geometric normal of the first triangle at the vertex where the file has none or zero.
fn normals(
    gather: &Gather,
    view: Option<&View>,
    triangles: &[[u32; 3]],
    positions: &[Vec3],
    warnings: &mut Warnings,
) -> Result<Vec<Vec3>, Refusal> {
    let mut normals: Vec<Vec3> =
        gather.optional::<3>(view, "NORMAL", 0.0)?.into_iter().map(|n| unit(Vec3::from(n).as_dvec3())).collect();
    let mut replaced = 0;
    for triangle in triangles {
        for vertex in triangle.map(|v| v as usize) {
            if normals[vertex] == Vec3::ZERO {
                let [a, b, c] = triangle.map(|v| positions[v as usize].as_dvec3());
                normals[vertex] = unit((b - a).cross(c - a));
                replaced += 1;
            }
        }
    }
    if view.is_some() {
        let message = "normals of length zero are replaced by that of the triangle";
        warnings.push_many(WarningKind::BadNormals, gather.place, replaced, message);
    }
    Ok(normals)
}

/// A unit vector, or zero.
fn unit(v: DVec3) -> Vec3 {
    v.try_normalize().unwrap_or_default().as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slivers_down_to_rounding_are_kept_and_lines_are_not() {
        let triangle = |h: f64| is_flat([DVec3::ZERO, DVec3::X, DVec3::new(0.5, h, 0.0)]);
        assert!(!triangle(1.0) && !triangle(1e-6) && !triangle(1e-13));
        assert!(triangle(0.0) && triangle(1e-15));
        assert!(is_flat([DVec3::ONE; 3]));
        assert!(is_flat([DVec3::ZERO, DVec3::X * 1e-20, DVec3::Y * 1e-20]));
    }

    #[test]
    fn compacting_keeps_order_and_unsharing_splits() {
        let mut triangles = [[9, 4, 7], [4, 9, 2]];
        assert_eq!(compact(&mut triangles), [2, 4, 7, 9]);
        assert_eq!(triangles, [[3, 1, 2], [1, 3, 0]]);
        let mut triangles = [[9, 4, 7], [4, 9, 2]];
        assert_eq!(unshare(&mut triangles), [9, 4, 7, 4, 9, 2]);
        assert_eq!(triangles, [[0, 1, 2], [3, 4, 5]]);
    }
}
