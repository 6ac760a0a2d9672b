!> Beams by the stiffnesses of their cross-section: the stiffness of a straight Timoshenko beam of two nodes.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Six deformations: elongation, twist, and the rotations of both ends against the line that joins their centroids. Bending is
!! the exact solution between loaded ends, from the compliances of bending and shear, so that one element is right at its nodes:
!! J. S. Przemieniecki, Theory of Matrix Structural Analysis, McGraw-Hill 1968, section 5.6; here with both planes of bending
!! coupled by the product of inertia. A pull acts at the centroid, a shear force at the shear centre. Rotations are small. Theory:
!! doc/theory/elements.md, section "Beams by their section".
module amontons_section_beams
  use amontons_kinds, only: DP
  use amontons_tensor, only: cross_product
  use amontons_user_elements, only: section_stiffness_type
  implicit none
  private
  public :: find_section_axes, evaluate_section_beam

contains

  !> Axis 1, axis 2 and tangent of a beam. is_ok: it has a length, and the direction is not along it.
  pure subroutine find_section_axes(x, direction, axes, length, is_ok)
    real(DP), intent(in) :: x(3, 2)                !< both nodes [length]
    real(DP), intent(in) :: direction(3)
    real(DP), intent(out) :: axes(3, 3)            !< columns [-]
    real(DP), intent(out) :: length                !< [length]
    logical, intent(out) :: is_ok
    real(DP), parameter :: MIN_SINE = 1.0e-6_DP    !< between direction and tangent [-]
    axes = 0
    length = norm2(x(:, 2) - x(:, 1))
    is_ok = length > 0 .and. norm2(direction) > 0
    if (.not. is_ok) return
    axes(:, 3) = (x(:, 2) - x(:, 1)) / length
    axes(:, 1) = direction / norm2(direction)
    axes(:, 1) = axes(:, 1) - dot_product(axes(:, 1), axes(:, 3)) * axes(:, 3)
    is_ok = norm2(axes(:, 1)) > MIN_SINE
    if (.not. is_ok) return
    axes(:, 1) = axes(:, 1) / norm2(axes(:, 1))
    axes(:, 2) = cross_product(axes(:, 3), axes(:, 1))
  end subroutine find_section_axes


  !> The stiffness by displacements and rotations of the first node, then of the second. is_ok: as in `find_section_axes`.
  pure subroutine evaluate_section_beam(section, x, stiffness, is_ok)
    type(section_stiffness_type), intent(in) :: section
    real(DP), intent(in) :: x(3, 2)                !< both nodes [length]
    real(DP), intent(out) :: stiffness(12, 12)     !< [force/length, force, force length]
    logical, intent(out) :: is_ok
    real(DP) :: axes(3, 3), length, by_nodes(6, 12), D(6, 6)
    real(DP) :: compliance(2, 2), equal(2, 2), opposite(2, 2), shear(2, 2)
    stiffness = 0
    call find_section_axes(x, section%direction, axes, length, is_ok)
    if (.not. is_ok) return
    by_nodes = deformations(section, axes, length)
    shear = 0                                      ! a moment about axis 1 is carried by the shear along axis 2
    shear(1, 1) = 1 / section%shear(2)
    shear(2, 2) = 1 / section%shear(1)
    compliance = inverse(section%bending)
    equal = inverse(length / 6 * compliance + 2 / length * shear)   ! both ends turn by the same angle
    opposite = inverse(length / 2 * compliance)                     ! by opposite angles: uniform curvature
    D = 0
    D(1, 1) = section%axial / length
    D(2, 2) = section%torsion / length
    D(3:4, 3:4) = 0.5_DP * (equal + opposite)
    D(5:6, 5:6) = D(3:4, 3:4)
    D(3:4, 5:6) = 0.5_DP * (equal - opposite)
    D(5:6, 3:4) = D(3:4, 5:6)
    stiffness = matmul(transpose(by_nodes), matmul(D, by_nodes))
  end subroutine evaluate_section_beam


  !> The six deformations by the displacements and rotations of both nodes.
  pure function deformations(section, axes, length) result(B)
    type(section_stiffness_type), intent(in) :: section
    real(DP), intent(in) :: axes(3, 3)             !< [-]
    real(DP), intent(in) :: length                 !< [length]
    real(DP) :: B(6, 12), arm(3), moved(6, 3)
    integer :: k
    moved = 0                                      ! deformations by the displacement of the second end
    moved(1, :) = axes(:, 3)
    moved(3, :) = axes(:, 2) / length
    moved(4, :) = -axes(:, 1) / length
    moved(5:6, :) = moved(3:4, :)
    B = 0
    B(2, 4:6) = -axes(:, 3)
    B(2, 10:12) = axes(:, 3)
    B(3:4, 4:6) = transpose(axes(:, :2))
    B(5:6, 10:12) = transpose(axes(:, :2))
    B(:, 1:3) = -moved
    B(:, 7:9) = moved
    do k = 1, 6                                    ! that of centroid or shear centre by rotation x arm: row . (rotation x arm)
      arm = matmul(axes(:, :2), merge(section%centroid, section%shear_center, k == 1))
      B(k, 4:6) = B(k, 4:6) - cross_product(arm, moved(k, :))
      B(k, 10:12) = B(k, 10:12) + cross_product(arm, moved(k, :))
    end do
  end function deformations


  !> The inverse of a symmetric matrix with a positive determinant.
  pure function inverse(A) result(B)
    real(DP), intent(in) :: A(2, 2)
    real(DP) :: B(2, 2)
    B(1, :) = [A(2, 2), -A(1, 2)]
    B(2, :) = [-A(2, 1), A(1, 1)]
    B = B / (A(1, 1) * A(2, 2) - A(1, 2) * A(2, 1))
  end function inverse

end module amontons_section_beams
