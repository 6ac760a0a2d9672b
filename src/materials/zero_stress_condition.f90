!> Plane-stress and uniaxial-stress conditions by a local Newton iteration on the free normal strains.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Plane stress has zero stress across the thickness, a truss zero stress across its axis. Newton's method with the law's own
!! tangent finds the free logarithmic strains at each point. It starts anew each time: nothing is stored, and a
!! linear law needs one correction. The remaining tangent is condensed exactly: c_ab - c_af (c_ff)^-1 c_fb. A correction that does
!! not reduce the stresses is halved: the path crosses the yield surface, where full corrections may oscillate without
!! end. The transverse shears (yz, xz) are taken as zero.
!! Reference: E. A. de Souza Neto, D. Peric, D. R. J. Owen, Computational methods for plasticity, Wiley 2008, chapter 9.
module amontons_zero_stress_condition
  use amontons_kinds, only: DP
  use amontons_material_point, only: material_point_type, update_material_point, cut_stress
  use amontons_materials, only: material_type
  use amontons_element_integration_points, only: integration_points_type, set_point_input
  use amontons_elasticity, only: small_strain_stress, finite_strain_stress, STRESS_OK, STRESS_INVERTED, STRESS_NOT_FINITE
  use amontons_tensor, only: pack_voigt
  use amontons_logarithmic_strain, only: expm1
  implicit none
  private
  public :: solve_zero_stress, evaluate_initial_tangent
  public :: CONDITION_NONE, CONDITION_PLANE_STRESS, CONDITION_UNIAXIAL

  integer, parameter :: CONDITION_NONE = 0            !< all strains are given
  integer, parameter :: CONDITION_PLANE_STRESS = 1    !< the normal strain 33 is free
  integer, parameter :: CONDITION_UNIAXIAL = 2        !< 22 and 33 are free

  integer, parameter :: MAX_STRAIN_CORRECTIONS = 80
  real(DP), parameter :: TOL_STRESS = 1.0e-13_DP           !< of the largest stress: converged [-]
  real(DP), parameter :: TOL_STRESS_ACCEPTABLE = 1.0e-9_DP       !< of the largest stress: where the corrections end [-]
  real(DP), parameter :: TOL_STRAIN_ROUNDING = 1.0e-14_DP        !< a correction this small over the strains is rounding [-]
  real(DP), parameter :: MAX_CORRECTION_SIZE = 0.5_DP  !< of a logarithmic strain [-]

contains

  !> Stress and tangent of a point under a zero-stress condition; at small strain too the strains are computed from point%H.
  pure subroutine solve_zero_stress(condition, material, is_nlgeom, point, status)
    integer, intent(in) :: condition               !< CONDITION_...
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom               !< .true.: finite strain, Kirchhoff stress
    type(material_point_type), intent(inout) :: point       !< in: H, past, ...; out: stress, tangent with the free strains
                                                   !< condensed, strain, energy, history; the free (2, 2), (3, 3) of H
    integer, intent(out) :: status                 !< STRESS_...
    real(DP) :: e(3), correction(3), largest, stress_residual, previous_residual
    integer :: first, i, step
    logical :: is_converged
    first = 4 - condition
    if (condition /= CONDITION_NONE) point%is_tangent_wanted = .true.    ! the iteration uses it
    if (condition /= CONDITION_NONE .and. allocated(point%user)) then
      if (point%user%values%ndi < 3) then
        call evaluate_reduced_law(condition, material, is_nlgeom, point, status)
        return
      end if
    end if
    point%is_cut_later = condition /= CONDITION_NONE   ! the free strains are those of the elastic law
    is_converged = .false.
    e = 0
    correction = 0
    previous_residual = huge(previous_residual)
    do step = 0, MAX_STRAIN_CORRECTIONS
      do i = first, 3
        point%H(i, i) = e(i)
        if (is_nlgeom) point%H(i, i) = expm1(e(i))
      end do
      call evaluate_law(material, is_nlgeom, point, status)
      if (status /= STRESS_OK .or. condition == CONDITION_NONE) return
      largest = maxval(abs(point%stress))
      stress_residual = maxval(abs(point%stress(first:3)))
      if (stress_residual <= TOL_STRESS * largest) exit
      if (stress_residual < previous_residual) then
        previous_residual = stress_residual
        call find_newton_correction(first, is_nlgeom, point%stress, point%tangent, correction)
        correction(first:) = sign(min(abs(correction(first:)), MAX_CORRECTION_SIZE), correction(first:))
      else                                           ! back by half
        correction = correction / 2
        e(first:) = e(first:) - 2 * correction(first:)
      end if
      is_converged = maxval(abs(correction(first:))) <= TOL_STRAIN_ROUNDING * maxval(abs(point%H))
      if (is_converged) exit
      e(first:) = e(first:) + correction(first:)
    end do
    if (.not. (is_converged .or. maxval(abs(point%stress(first:3))) <= TOL_STRESS_ACCEPTABLE * largest)) status = STRESS_NOT_FINITE
    call condense_tangent(first, point%tangent)
    point%stress(first:3) = 0
    if (status == STRESS_OK) call cut_stress(material, is_nlgeom, point)
  end subroutine solve_zero_stress


  !> A user law with only the nonzero stress components. At finite strain the volume is constant, as in Abaqus for such
  !! elements; at small strain the transverse strains are unknown and stay zero.
  pure subroutine evaluate_reduced_law(condition, material, is_nlgeom, point, status)
    integer, intent(in) :: condition               !< CONDITION_PLANE_STRESS or CONDITION_UNIAXIAL
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    type(material_point_type), intent(inout) :: point       !< in: H, past, ...; out: stress, tangent, strain, energy, history
    integer, intent(out) :: status                 !< STRESS_...
    real(DP) :: area
    point%H(3, 3) = 0
    if (condition == CONDITION_UNIAXIAL) point%H(2, 2) = 0
    if (is_nlgeom) then
      area = (1 + point%H(1, 1)) * (1 + point%H(2, 2)) - point%H(1, 2) * point%H(2, 1)
      status = STRESS_INVERTED
      if (.not. area > 0) return
      point%H(3, 3) = 1 / area - 1
      if (condition == CONDITION_UNIAXIAL) point%H(3, 3) = 1 / sqrt(area) - 1
      if (condition == CONDITION_UNIAXIAL) point%H(2, 2) = point%H(3, 3)
    end if
    call evaluate_law(material, is_nlgeom, point, status)
  end subroutine evaluate_reduced_law


  !> The tangent of an undeformed point without history: the elastic constants.
  pure subroutine evaluate_initial_tangent(condition, material, is_nlgeom, n, points, c)
    integer, intent(in) :: condition               !< CONDITION_...
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    integer, intent(in) :: n                       !< nodes of the element: their mean temperature counts
    type(integration_points_type), intent(in) :: points
    real(DP), intent(out) :: c(6, 6)               !< engineering shears [stress]
    type(material_point_type) :: point
    integer :: status
    call set_point_input(material, points, 1, [real(DP) ::], point)
    if (allocated(point%user)) deallocate (point%user)
    if (allocated(point%inner_old)) point%inner_old = 0
    point%time_increment = 0                       ! at once, without flow
    point%elapsed_time = 0
    if (.not. material%is_linear_isotropic) then
      point%history_old = 0
      point%temperature = sum(points%temperature(:n)) / real(n, DP)
      point%initial_temperature = point%temperature     ! no thermal strain
      if (material%table_variable > 0) point%field = sum(points%field(:n)) / real(n, DP)
      point%initial_field = point%field
    end if
    point%H = 0
    point%is_tangent_wanted = .true.
    call solve_zero_stress(condition, material, is_nlgeom, point, status)
    c = point%tangent
  end subroutine evaluate_initial_tangent


  !> Newton's correction of the free logarithmic strains: d tau_i = (c_ij + 2 tau_i delta_ij) d e_j.
  pure subroutine find_newton_correction(first, is_nlgeom, tau, c, correction)
    integer, intent(in) :: first                   !< free are first to 3
    logical, intent(in) :: is_nlgeom
    real(DP), intent(in) :: tau(6), c(6, 6)
    real(DP), intent(out) :: correction(3)
    real(DP) :: slope(3, 3), det
    integer :: i
    correction = 0
    slope = c(:3, :3)
    if (is_nlgeom) then
      do i = 1, 3
        slope(i, i) = slope(i, i) + 2 * tau(i)
      end do
    end if
    if (first == 3) then
      correction(3) = -tau(3) / slope(3, 3)
    else
      det = slope(2, 2) * slope(3, 3) - slope(2, 3) * slope(3, 2)
      correction(2) = (slope(2, 3) * tau(3) - slope(3, 3) * tau(2)) / det
      correction(3) = (slope(3, 2) * tau(2) - slope(2, 2) * tau(3)) / det
    end if
  end subroutine find_newton_correction


  !> Condenses the free strains and all transverse shears out of the tangent, one after the other.
  pure subroutine condense_tangent(first, c)
    integer, intent(in) :: first                   !< free are first to 3
    real(DP), intent(inout) :: c(6, 6)
    real(DP) :: row(6), column(6)
    integer :: f, i
    do f = 3, first, -1
      row = c(f, :) / c(f, f)
      column = c(:, f)
      do i = 1, 6
        c(:, i) = c(:, i) - column * row(i)
      end do
      c(f, :) = 0
      c(:, f) = 0
    end do
  end subroutine condense_tangent


  !> Evaluates the law.
  pure subroutine evaluate_law(material, is_nlgeom, point, status)
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    type(material_point_type), intent(inout) :: point
    integer, intent(out) :: status                 !< STRESS_...
    if (.not. is_nlgeom) point%strain = pack_voigt(point%H)
    if (.not. material%is_linear_isotropic) then
      call update_material_point(material, is_nlgeom, point, status)
    else if (is_nlgeom) then
      call finite_strain_stress(material, point%H, point%stress, point%tangent, point%strain, point%energy, status)
    else
      status = STRESS_OK
      call small_strain_stress(material, point%strain, point%stress, point%tangent, point%energy)
    end if
  end subroutine evaluate_law

end module amontons_zero_stress_condition
