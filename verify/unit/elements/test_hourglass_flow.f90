!> Unit test of amontons_hourglass_flow: bricks and squares of perfectly plastic steel, bent alone and bent while they flow.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_hourglass_flow
  use amontons_element, only: evaluate_element_forces
  use amontons_element_integration_points, only: integration_points_type, ELEMENT_OK
  use amontons_element_kinds, only: KIND_C3D8R, KIND_CPS4R, MAX_ELEMENT_NODES
  use amontons_hourglass_flow, only: has_hourglass_flow
  use amontons_kinds, only: DP
  use amontons_materials, only: material_type, LAW_SAINT_VENANT, LAW_HENCKY, HISTORY_INELASTIC
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  real(DP), parameter :: YOUNG = 200000, YIELD = 200
  real(DP), parameter :: SIGNS(3, 8) = reshape([real(DP) :: &
    -1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1], [3, 8])
  type(material_type) :: steel
  logical :: is_nlgeom
  integer :: i
  call set_steel(steel)
  call test_choice()
  is_nlgeom = .false.
  do i = 1, 2
    call test_bending(KIND_C3D8R, is_nlgeom)
    call test_bending(KIND_CPS4R, is_nlgeom)
    call test_bent_while_stretched(is_nlgeom)
    is_nlgeom = .true.
  end do
  call suite%finish()

contains

  !> Perfectly plastic steel.
  subroutine set_steel(material)
    type(material_type), intent(out) :: material
    material%law = LAW_HENCKY
    material%is_linear_isotropic = .false.
    material%youngs_modulus = YOUNG
    material%poissons_ratio = 0.3_DP
    material%n_history = HISTORY_INELASTIC + 5
    allocate (material%isotropic_hardening(1))
    material%isotropic_hardening(1)%strain = [0.0_DP]
    material%isotropic_hardening(1)%stress = [YIELD]
  end subroutine set_steel


  !> A virgin element.
  subroutine reset(points)
    type(integration_points_type), intent(out) :: points
    points%section_value = 1
    points%has_frame = .false.
    points%history_old = 0
    points%temperature = 0
    points%initial_temperature = 0
    points%time = 1
    points%time_increment = 0
  end subroutine reset


  !> The nodes of a cube or square with edges of length 2, and displacements: bent about y (in the plane: about z) by a curvature,
  !! stretched along x.
  subroutine bend(kind, curvature, strain, X, u)
    integer, intent(in) :: kind
    real(DP), intent(in) :: curvature              !< [1/length]
    real(DP), intent(in) :: strain                 !< [-]
    real(DP), intent(out) :: X(3, 8), u(3, 8)
    integer :: across
    across = merge(3, 2, kind == KIND_C3D8R)
    X = SIGNS
    u = 0
    u(1, :) = strain * X(1, :) - curvature * X(1, :) * X(across, :)
    u(2, :) = -0.5_DP * strain * X(2, :)
    u(3, :) = -0.5_DP * strain * X(3, :)
    if (kind == KIND_CPS4R) then
      X(3, :) = 0
      u(3, :) = 0
    end if
  end subroutine bend


  !> The moment about the axis of bending [force length].
  real(DP) function moment(kind, X, force) result(m)
    integer, intent(in) :: kind
    real(DP), intent(in) :: X(3, 8), force(3, MAX_ELEMENT_NODES)
    integer :: n, across
    n = merge(8, 4, kind == KIND_C3D8R)
    across = merge(3, 2, kind == KIND_C3D8R)
    m = -sum(force(1, :n) * X(across, :n) * X(1, :n)) / 2
  end function moment


  !> Which materials have it.
  subroutine test_choice()
    type(material_type) :: other
    call suite%that('steel', has_hourglass_flow(steel))
    other = steel
    other%law = LAW_SAINT_VENANT
    call suite%that('calculix dialect', .not. has_hourglass_flow(other))
    other = steel
    other%is_user = .true.
    call suite%that('user', .not. has_hourglass_flow(other))
    other = steel
    other%n_history = 0
    call suite%that('elastic', .not. has_hourglass_flow(other))
  end subroutine test_choice


  !> Evaluates an element at the end of an increment, and again at the start of the next one: what the law holds.
  subroutine load(kind, is_nlgeom, curvature, strain, points, held)
    integer, intent(in) :: kind
    logical, intent(in) :: is_nlgeom
    real(DP), intent(in) :: curvature              !< [1/length]
    real(DP), intent(in) :: strain                 !< [-]
    type(integration_points_type), intent(inout) :: points
    real(DP), intent(out) :: held                  !< moment [force length]
    real(DP) :: X(3, 8), u(3, 8), force(3, MAX_ELEMENT_NODES)
    integer :: n, i, status
    n = merge(8, 4, kind == KIND_C3D8R)
    call bend(kind, curvature, strain, X, u)
    do i = 1, 2
      points%is_output_wanted = i == 1
      call evaluate_element_forces(kind, steel, X(:, :n), u(:, :n), is_nlgeom, force, points, status)
      if (i == 1) points%modes_old = points%modes
      if (i == 1) points%history_old = points%history
    end do
    call suite%that('finite', status == ELEMENT_OK)
    held = moment(kind, X, force)
  end subroutine load


  !> Bent alone: elastic at first; then the fully plastic moment of two Gauss points, 2/sqrt(3) of that of the rectangle, whether
  !! the curvature comes in one increment or in many; unloading is elastic, and reverse bending yields the other way.
  subroutine test_bending(kind, is_nlgeom)
    integer, intent(in) :: kind
    logical, intent(in) :: is_nlgeom
    type(integration_points_type) :: points
    real(DP) :: curvature, limit, elastic, before, held, dissipated
    integer :: k
    limit = YIELD * 2 / sqrt(3.0_DP)               ! b h^2 / 4 = 1 of the square; the brick is twice as wide, and in plane strain
    if (kind == KIND_C3D8R) limit = limit * 2 * 2 / sqrt(3.0_DP)
    call reset(points)
    call load(kind, is_nlgeom, 1.0e-4_DP, 0.0_DP, points, held)
    elastic = held / 1.0e-4_DP
    call suite%that('elastic', elastic > 0 .and. all(abs(points%modes_old(:12)) <= 0))
    do k = 1, 20
      curvature = 0.001_DP * real(k, DP)
      call load(kind, is_nlgeom, curvature, 0.0_DP, points, held)
    end do
    before = held
    call suite%near('the plastic moment in 20 increments', before / limit, 1.0_DP, 0.05_DP)
    dissipated = points%modes_old(26)
    call suite%that('dissipation', dissipated > 0)
    call load(kind, is_nlgeom, curvature - 1.0e-4_DP, 0.0_DP, points, held)
    call suite%near('unloading is elastic', (before - held) / (1.0e-4_DP * elastic), 1.0_DP, 0.05_DP)
    call suite%near('unloading dissipates next to nothing', points%modes_old(26) / dissipated, 1.0_DP, 1.0e-3_DP)
    call load(kind, is_nlgeom, curvature - 0.01_DP, 0.0_DP, points, held)
    call suite%near('reverse bending', held / before, -1.0_DP, 0.05_DP)
    call reset(points)
    call load(kind, is_nlgeom, curvature, 0.0_DP, points, held)
    call suite%near('the same in one increment', held / before, 1.0_DP, 0.07_DP)
  end subroutine test_bending


  !> Bent while it flows along x: no part of the bar can carry more, so that no moment is held.
  subroutine test_bent_while_stretched(is_nlgeom)
    logical, intent(in) :: is_nlgeom
    type(integration_points_type) :: points
    real(DP) :: held
    call reset(points)
    call load(KIND_C3D8R, is_nlgeom, 0.002_DP, 0.01_DP, points, held)
    call suite%that('no moment', abs(held) < 0.03_DP * 2 * YIELD)
  end subroutine test_bent_while_stretched

end program test_hourglass_flow
