!> Input and output data of the integration points of one element, and the status codes of elements.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_element_integration_points
  use amontons_kinds, only: DP
  use amontons_material_point, only: material_point_type
  use amontons_materials, only: spring_type, material_type, MAX_HISTORY
  use amontons_tensor, only: IDENTITY, determinant_minus_one
  use amontons_element_kinds, only: MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS, MAX_ELEMENT_AMPLITUDES
  use amontons_user_material, only: umat_point_type
  use amontons_user_routines, only: creep_type
  implicit none
  private
  public :: integration_points_type, set_point_input, store_point_output, store_point_history, &
    split_unsymmetric_tangent, TOL_SYMMETRIC
  public :: ELEMENT_OK, ELEMENT_INVERTED, ELEMENT_NOT_FINITE, ELEMENT_DEGENERATE

  integer, parameter :: ELEMENT_OK = 0             !< all is well
  integer, parameter :: ELEMENT_INVERTED = 1       !< det F is not positive at an integration point
  integer, parameter :: ELEMENT_NOT_FINITE = 2     !< a displacement is NaN, infinite or beyond all bounds
  integer, parameter :: ELEMENT_DEGENERATE = 3     !< the undeformed volume of a point is not positive

  real(DP), parameter :: TOL_SYMMETRIC = 1.0e-10_DP    !< a smaller skew part relative to the largest entry is rounding [-]

  !> Input and output at the integration points of one element; entries past its points are undefined. The history,
  !! temperatures and times are read only by history-dependent or user laws; plain elasticity leaves the history unchanged.
  type :: integration_points_type
    ! input: section, committed history, temperature
    real(DP) :: section_value                            !< thickness [length], cross-section [length^2], spring constant
    logical :: is_shell = .false.                  !< the solid is one layer of an expanded shell, CSS6: the only one
    real(DP) :: stack_bending(2, 2) = 0            !< CSS6, one of several layers: stiffness of the bubble [stress/length]
    real(DP) :: walls(4) = 0                       !< of a hollow beam, see mesh [-]
    real(DP) :: cohesive(2) = [1.0_DP, 0.0_DP]     !< of cohesive elements: thickness of their strains [length], viscosity [time]
    integer :: directions(2)                       !< of SPRING1, SPRING2
    type(spring_type), allocatable :: spring       !< law of a spring or gap that is more than a constant
    logical :: has_frame                           !< frame is set; else the axes are the global ones
    real(DP) :: frame(3, 3, MAX_ELEMENT_POINTS)            !< local axes of the material in columns
    real(DP) :: history_old(MAX_HISTORY, MAX_ELEMENT_POINTS)      !< committed history
    real(DP) :: temperature(MAX_ELEMENT_NODES)             !< of the nodes, at the end of the increment [temperature]
    real(DP) :: initial_temperature(MAX_ELEMENT_NODES)     !< of the nodes [temperature]
    real(DP) :: field(MAX_ELEMENT_NODES)           !< of the nodes: field variable that the tables are over
    real(DP) :: initial_field(MAX_ELEMENT_NODES)   !< the same at the start
    real(DP) :: point_field(MAX_ELEMENT_POINTS)    !< this field variable by USDFLD, if the material has it
    real(DP) :: time                               !< at the end of the increment [time]
    real(DP) :: time_increment                     !< of creep and viscoelasticity: 0 outside of VISCO steps [time]
    logical :: is_rate_at_end = .false.            !< time hardening: the rate is that at the end of the increment, not its mean
    real(DP) :: elapsed_time = 0                   !< length of the increment, of rates that count in every step [time]
    real(DP), allocatable :: inner_old(:, :)       !< (n_inner, MAX_ELEMENT_POINTS) committed history of a law beyond MAX_HISTORY
    type(umat_point_type), allocatable :: user(:)  !< (points) of a user's material
    type(creep_type), allocatable :: creep(:)      !< (points) what a routine CREEP gets
    real(DP) :: modes_old(MAX_ELEMENT_AMPLITUDES) = 0   !< committed amplitudes of the incompatible modes, without the mean
                                                   !! deformation, or of hourglass modes that have flowed [length], and the energy
                                                   !! that this dissipated
    logical :: is_tangent_wanted = .true.          !< if not, tangents of laws are not set
    logical :: is_output_wanted = .true.           !< if not, strain, energy and history need not be set
    ! output
    real(DP) :: modes(MAX_ELEMENT_AMPLITUDES) = 0  !< the same at the end of the increment
    real(DP) :: history(MAX_HISTORY, MAX_ELEMENT_POINTS)   !< at the end of the increment
    real(DP), allocatable :: inner(:, :)           !< the same at the end of the increment
    real(DP) :: stress(6, MAX_ELEMENT_POINTS)              !< Cauchy stress, xx yy zz xy yz xz [stress]
    real(DP) :: strain(6, MAX_ELEMENT_POINTS)              !< small, logarithmic or Green's strain, tensor components [-]
    real(DP) :: energy(MAX_ELEMENT_POINTS)                 !< strain energy per reference volume [stress]
    real(DP) :: volume(MAX_ELEMENT_POINTS)                 !< reference volume of the point: weight times determinant [length^3]
    real(DP), allocatable :: skew(:, :, :)         !< (6, 6, MAX_ELEMENT_POINTS) (c - c')/2 of an unsymmetric law [stress]
  end type integration_points_type

contains

  !> Input of the material law at a point, except the strain.
  pure subroutine set_point_input(material, points, p, weight, point)
    type(material_type), intent(in) :: material
    type(integration_points_type), intent(in) :: points
    integer, intent(in) :: p                       !< point
    real(DP), intent(in) :: weight(:)              !< of the nodal temperatures [-]
    type(material_point_type), intent(inout) :: point
    point%is_tangent_wanted = points%is_tangent_wanted
    point%is_output_wanted = points%is_output_wanted
    point%frame = IDENTITY
    if (material%is_linear_isotropic) return
    if (points%has_frame) point%frame = points%frame(:, :, p)
    point%time = points%time
    point%time_increment = points%time_increment
    point%is_rate_at_end = points%is_rate_at_end
    point%temperature = dot_product(weight, points%temperature(:size(weight)))
    point%initial_temperature = dot_product(weight, points%initial_temperature(:size(weight)))
    if (material%table_variable > 0) then
      point%field = dot_product(weight, points%field(:size(weight)))
      if (material%is_user_field .and. size(weight) > 0) point%field = points%point_field(p)
      point%initial_field = dot_product(weight, points%initial_field(:size(weight)))
    end if
    point%elapsed_time = points%elapsed_time
    point%history_old = points%history_old(:, p)
    if (allocated(points%inner_old)) point%inner_old = points%inner_old(:, p)
    if (allocated(points%creep)) then
      if (p <= size(points%creep)) point%creep = points%creep(p)
    end if
    if (.not. allocated(points%user)) return
    if (p <= size(points%user)) point%user = points%user(p)
  end subroutine set_point_input


  !> Output at a point: Cauchy stress, strain, energy, history.
  pure subroutine store_point_output(material, is_nlgeom, point, points, p)
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    type(material_point_type), intent(in) :: point
    type(integration_points_type), intent(inout) :: points
    integer, intent(in) :: p                       !< point
    points%stress(:, p) = point%stress
    if (is_nlgeom) points%stress(:, p) = point%stress / (1 + determinant_minus_one(point%H))
    points%strain(:, p) = point%strain
    points%energy(p) = point%energy
    if (.not. material%is_linear_isotropic) call store_point_history(point, points, p)
  end subroutine store_point_output


  !> Splits the tangent of a point: the symmetric part for the element kernels, the skew part of an unsymmetric law kept apart.
  pure subroutine split_unsymmetric_tangent(material, point, points, p)
    type(material_type), intent(in) :: material
    type(material_point_type), intent(inout) :: point       !< in: tangent; out: its symmetric part
    type(integration_points_type), intent(inout) :: points     !< out: skew
    integer, intent(in) :: p                       !< point
    real(DP) :: skew(6, 6)
    if (.not. material%is_unsymmetric) return
    skew = 0.5_DP * (point%tangent - transpose(point%tangent))
    point%tangent = 0.5_DP * (point%tangent + transpose(point%tangent))
    if (all(abs(skew) <= TOL_SYMMETRIC * maxval(abs(point%tangent)))) skew = 0
    if (all(skew == 0.0_DP) .and. .not. allocated(points%skew)) return
    if (.not. allocated(points%skew)) allocate (points%skew(6, 6, MAX_ELEMENT_POINTS), source=0.0_DP)
    points%skew(:, :, p) = skew
  end subroutine split_unsymmetric_tangent


  !> Copies the history of a point to that of its element.
  pure subroutine store_point_history(point, points, p)
    type(material_point_type), intent(in) :: point
    type(integration_points_type), intent(inout) :: points
    integer, intent(in) :: p                       !< point
    points%history(:, p) = point%history
    if (allocated(point%inner)) points%inner(:, p) = point%inner
    if (allocated(point%user)) points%user(p)%history = point%user%history
  end subroutine store_point_history

end module amontons_element_integration_points
