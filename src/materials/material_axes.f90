!> The local axes of a material at a point, by the orientation of its section.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_material_axes
  use amontons_kinds, only: DP
  use amontons_materials, only: orientation_type, SYSTEM_CYLINDRICAL
  use amontons_tensor, only: IDENTITY, cross_product
  implicit none
  private
  public :: evaluate_orientation

contains

  !> The local axes of an orientation at a point. Rectangular: x through a, y towards b. Cylindrical: z from a to b, x
  !! radial (global x or y where the place is on the axis). They may be projected on a shell.
  pure function evaluate_orientation(orientation, place, normal) result(frame)
    type(orientation_type), intent(in) :: orientation
    real(DP), intent(in) :: place(3)               !< [length]
    real(DP), intent(in) :: normal(3)              !< of the shell, a unit vector; used where the axes are projected
    real(DP) :: frame(3, 3)                        !< axes in columns
    real(DP) :: x(3), z(3)
    if (orientation%system == SYSTEM_CYLINDRICAL) then
      z = (orientation%b - orientation%a) / norm2(orientation%b - orientation%a)
      x = place - orientation%a
      x = x - dot_product(x, z) * z
      if (norm2(x) <= 1.0e-12_DP * norm2(orientation%b - orientation%a)) then
        x = IDENTITY(:, minloc(abs(z), 1))
        x = x - dot_product(x, z) * z
      end if
    else
      x = orientation%a
      z = cross_product(orientation%a, orientation%b)
    end if
    x = x / norm2(x)
    z = z / norm2(z)
    frame(:, 1) = x
    frame(:, 2) = cross_product(z, x)
    frame(:, 3) = z
    if (orientation%is_projected) then
      frame = project_axes(frame, orientation%normal_axis, normal)
      call rotate_axes(3, orientation%rotation_angle + orientation%layer_angle, frame)
    else if (orientation%rotation_axis > 0) then
      call rotate_axes(orientation%rotation_axis, orientation%rotation_angle, frame)
    end if
  end function evaluate_orientation


  !> Axes on a shell: the first is the projection of the axis behind a given one, or of the given one where that axis is nearly
  !! along the normal; the third is the normal.
  pure function project_axes(frame, axis, normal) result(projected)
    real(DP), intent(in) :: frame(3, 3)            !< axes in columns
    integer, intent(in) :: axis                    !< 1 to 3
    real(DP), intent(in) :: normal(3)              !< a unit vector
    real(DP) :: projected(3, 3), x(3)
    real(DP), parameter :: TOL_ALONG = 1.745e-3_DP !< sine of 0.1 degree, as in Abaqus [-]
    x = frame(:, modulo(axis, 3) + 1)
    x = x - dot_product(x, normal) * normal
    if (norm2(x) < TOL_ALONG) x = frame(:, axis) - dot_product(frame(:, axis), normal) * normal
    projected(:, 1) = x / norm2(x)
    projected(:, 3) = normal
    projected(:, 2) = cross_product(normal, projected(:, 1))
  end function project_axes


  !> Turns the axes about one of them.
  pure subroutine rotate_axes(axis, angle, frame)
    integer, intent(in) :: axis                    !< 1 to 3
    real(DP), intent(in) :: angle                  !< [rad]
    real(DP), intent(inout) :: frame(3, 3)         !< axes in columns
    real(DP) :: a(3), b(3)
    integer :: i, j
    i = modulo(axis, 3) + 1
    j = modulo(axis + 1, 3) + 1
    a = frame(:, i)
    b = frame(:, j)
    frame(:, i) = cos(angle) * a + sin(angle) * b
    frame(:, j) = cos(angle) * b - sin(angle) * a
  end subroutine rotate_axes

end module amontons_material_axes
