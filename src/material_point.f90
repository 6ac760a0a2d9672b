!> Material point: stress, tangent, energy and history of a point of any material, from its strain and its past.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Stress and history are updated from the committed history, never from a trial one. Plain materials (E and nu, nothing
!! else) do not come here: module stress serves them. Every other law is of one of two sorts:
!!
!! | sort | laws | at finite strain |
!! |---|---|---|
!! | a law between six strains and six stresses | linear elasticity with axes, kinematic hardening | Green's strain (LAW_SAINT_VENANT) or the logarithmic strain of C (LAW_HENCKY) |
!! | an isotropic law in principal values | linear elasticity, isotropic hardening, creep, rubber, foam | principal logarithmic strains of the elastic b |
!!
!! Theory: doc/theory/materials.md.
module amontons_material_point
  use amontons_kinds, only: DP
  use amontons_materials, only: material_type, evaluate_table, LAW_SAINT_VENANT, ELASTIC_ISOTROPIC, MAX_HISTORY, &
    HISTORY_INELASTIC
  use amontons_principal, only: principal_type, find_principal, left_cauchy_green, principal_stress, principal_tangent
  use amontons_stress, only: hooke, isotropic_tangent, gradient_status, STRESS_OK, STRESS_INVERTED
  use amontons_tensor, only: IDENTITY, VOIGT_IDENTITY, VOIGT_ROW, VOIGT_COLUMN, double_dot, pack_voigt
  implicit none
  private
  public :: point_type, update_point

  !> What goes into a material point and what comes out. The past is committed: it is read, never written.
  type :: point_type
    ! comes in
    real(DP) :: H(3, 3)                            !< finite strain: displacement gradient, F = 1 + H [-]
    real(DP) :: strain(6)                          !< small strain: comes in; finite: goes out, logarithmic [-]
    real(DP) :: frame(3, 3)                        !< local axes of the material in its columns
    real(DP) :: temperature                        !< at the end of the increment [temperature]
    real(DP) :: initial_temperature                !< [temperature]
    real(DP) :: time                               !< at the end of the increment, for laws that know it [time]
    real(DP) :: time_increment                     !< [time]
    real(DP) :: past(MAX_HISTORY)                  !< committed history
    ! goes out
    real(DP) :: stress(6)                          !< small strain: stress; finite: Kirchhoff stress [stress]
    real(DP) :: tangent(6, 6)                      !< its derivative, spatial at finite strain, engineering shears [stress]
    real(DP) :: energy                             !< elastic, per reference volume [stress]
    real(DP) :: history(MAX_HISTORY)               !< at the end of the increment
  end type point_type

  !> What a material is at a temperature.
  type :: moduli_type
    real(DP) :: lambda = 0                         !< Lame's first constant of isotropic materials [stress]
    real(DP) :: G = 0                              !< shear modulus of isotropic materials [stress]
    real(DP) :: thermal(6) = 0                     !< thermal strain, tensor components in the global axes [-]
  end type moduli_type

contains

  !> Updates a point: stress, tangent, energy and history from strain, temperature and the committed history.
  pure subroutine update_point(material, is_nlgeom, point, status)
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    type(point_type), intent(inout) :: point       !< in and out as its type says
    integer, intent(out) :: status                 !< STRESS_...; if not STRESS_OK nothing that goes out is to be used
    type(moduli_type) :: moduli
    status = STRESS_OK
    point%history = point%past
    call find_moduli(material, point, moduli)
    if (.not. is_nlgeom) then
      call strain_law(moduli, point%strain, point)
    else
      status = gradient_status(point%H)
      if (status /= STRESS_OK) return
      if (material%law == LAW_SAINT_VENANT) then
        call update_green(moduli, point, status)
      else
        call update_principal(moduli, point, status)
      end if
    end if
  end subroutine update_point


  !> The constants at the temperature of a point, in the global axes.
  pure subroutine find_moduli(material, point, moduli)
    type(material_type), intent(in) :: material
    type(point_type), intent(in) :: point
    type(moduli_type), intent(out) :: moduli
    real(DP) :: constants(21)
    constants(:2) = [material%youngs_modulus, material%poissons_ratio]
    if (allocated(material%elastic%value)) call evaluate_table(material%elastic, point%temperature, &
      constants(:size(material%elastic%value, 1)))
    associate (E => constants(1), nu => constants(2))
      moduli%G = E / (2 * (1 + nu))
      moduli%lambda = E * nu / ((1 + nu) * (1 - 2 * nu))
    end associate
    if (allocated(material%expansion%value)) moduli%thermal = thermal_strain(material, point)
  end subroutine find_moduli


  !> The thermal strain since the start: a(T) (T - T0) - a(Ti) (Ti - T0), a the secant coefficient from T0 on.
  pure function thermal_strain(material, point) result(strain)
    type(material_type), intent(in) :: material
    type(point_type), intent(in) :: point
    real(DP) :: strain(6)                          !< global axes, tensor components [-]
    real(DP) :: now(6), start(6)
    integer :: n
    n = size(material%expansion%value, 1)
    call evaluate_table(material%expansion, point%temperature, now(:n))
    call evaluate_table(material%expansion, point%initial_temperature, start(:n))
    strain(:n) = now(:n) * (point%temperature - material%expansion_zero) &
      - start(:n) * (point%initial_temperature - material%expansion_zero)
    if (n == 1) strain = strain(1) * VOIGT_IDENTITY
  end function thermal_strain


  !> The law between six strains and six stresses.
  pure subroutine strain_law(moduli, strain, point)
    type(moduli_type), intent(in) :: moduli
    real(DP), intent(in) :: strain(6)              !< of any measure, tensor components [-]
    type(point_type), intent(inout) :: point
    real(DP) :: elastic(6)
    elastic = strain - moduli%thermal - point%past(HISTORY_INELASTIC:HISTORY_INELASTIC + 5)
    point%stress = hooke(moduli%lambda, moduli%G, elastic)
    point%tangent = isotropic_tangent(moduli%lambda, moduli%G)
    point%energy = 0.5_DP * double_dot(point%stress, elastic)
  end subroutine strain_law


  !> The law of six strains between Green's strain and the second Piola-Kirchhoff stress, pushed forward.
  pure subroutine update_green(moduli, point, status)
    type(moduli_type), intent(in) :: moduli
    type(point_type), intent(inout) :: point
    integer, intent(out) :: status                 !< STRESS_...
    type(principal_type) :: principal
    real(DP) :: push(6, 6)
    logical :: is_positive
    call find_principal(left_cauchy_green(point%H), principal, is_positive)
    status = merge(STRESS_OK, STRESS_INVERTED, is_positive)
    if (.not. is_positive) return
    point%strain = principal_stress(principal, principal%e)
    call strain_law(moduli, pack_voigt(point%H + 0.5_DP * matmul(transpose(point%H), point%H)), point)
    push = push_forward_matrix(IDENTITY + point%H)
    point%stress = matmul(push, point%stress)
    point%tangent = matmul(push, matmul(point%tangent, transpose(push)))
  end subroutine update_green


  !> The isotropic law in principal logarithmic strains.
  pure subroutine update_principal(moduli, point, status)
    type(moduli_type), intent(in) :: moduli
    type(point_type), intent(inout) :: point
    integer, intent(out) :: status                 !< STRESS_...
    type(principal_type) :: principal
    real(DP) :: e(3), tau(3), slope(3, 3)
    logical :: is_positive
    integer :: A
    call find_principal(left_cauchy_green(point%H), principal, is_positive)
    status = merge(STRESS_OK, STRESS_INVERTED, is_positive)
    if (.not. is_positive) return
    point%strain = principal_stress(principal, principal%e)
    e = principal%e - moduli%thermal(1)
    tau = 2 * moduli%G * e + moduli%lambda * (e(1) + e(2) + e(3))
    slope = moduli%lambda
    do A = 1, 3
      slope(A, A) = moduli%lambda + 2 * moduli%G
    end do
    point%stress = principal_stress(principal, tau)
    point%tangent = principal_tangent(principal, tau, slope, spread(2 * moduli%G, 1, 3))
    point%energy = 0.5_DP * dot_product(tau, e)
  end subroutine update_principal


  !> The matrix Q with tau = Q S and c = Q C Q^T for tau_ij = A_iI S_IJ A_jJ, c_ijkl = A_iI A_jJ C_IJKL A_kK A_lL.
  pure function push_forward_matrix(A) result(Q)
    real(DP), intent(in) :: A(3, 3)                !< F, or a rotation [-]
    real(DP) :: Q(6, 6)
    integer :: k, n
    do n = 1, 6
      associate (i => VOIGT_ROW, j => VOIGT_COLUMN)
        do k = 1, 6
          Q(k, n) = A(i(k), i(n)) * A(j(k), j(n))
          if (n > 3) Q(k, n) = Q(k, n) + A(i(k), j(n)) * A(j(k), i(n))
        end do
      end associate
    end do
  end function push_forward_matrix

end module amontons_material_point
