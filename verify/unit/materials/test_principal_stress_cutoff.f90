!> Unit test of principal_stress_cutoff: stresses of both cards, tangents by differences at small and finite strain, energy.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_principal_stress_cutoff
  use amontons_kinds, only: DP
  use amontons_elasticity, only: STRESS_OK
  use amontons_material_point, only: material_point_type, update_material_point
  use amontons_materials, only: material_type, property_table_type, ELASTIC_ORTHOTROPIC, has_no_energy, law_name
  use amontons_principal_stress_cutoff, only: cut_principal_stresses
  use amontons_tensor, only: IDENTITY, VOIGT_ROW, VOIGT_COLUMN, pack_voigt, unpack_voigt, symmetric_eigen
  use check, only: suite_type
  implicit none
  real(DP), parameter :: REMAINING = 1.0e-4_DP     !< stiffness of what is cut over the elastic one [-]
  real(DP), parameter :: STRAIN_A(6) = [0.012_DP, -0.007_DP, 0.001_DP, 0.004_DP, -0.003_DP, 0.002_DP]
  real(DP), parameter :: STRAIN_B(6) = [-0.012_DP, -0.007_DP, 0.011_DP, 0.001_DP, -0.003_DP, 0.002_DP]
  type(suite_type) :: suite
  type(material_type) :: isotropic, orthotropic
  integer :: side
  isotropic%youngs_modulus = 1000
  isotropic%poissons_ratio = 0.3_DP
  isotropic%is_linear_isotropic = .false.
  orthotropic = isotropic
  orthotropic%elastic_kind = ELASTIC_ORTHOTROPIC
  orthotropic%elastic = property_table_type([0.0_DP], reshape([real(DP) :: 1400, 300, 900, 200, 350, 700, 250, 310, 190], [9, 1]))
  call check_values()
  do side = -1, 1, 2
    isotropic%cutoff_sign = side
    orthotropic%cutoff_sign = side
    call check_material('isotropic', isotropic)
    call check_material('orthotropic', orthotropic)
  end do
  call suite%finish()

contains

  !> A diagonal stress, one that stays, one that goes.
  subroutine check_values()
    real(DP) :: stress(6), tangent(6, 6)
    tangent = 0
    stress = [real(DP) :: 3, -2, 1, 0, 0, 0]
    call cut_principal_stresses(1, .false., .false., stress, tangent)
    call suite%near('no compression', norm2(stress - [real(DP) :: 3, 0, 1, 0, 0, 0]), 0.0_DP, 1.0e-13_DP)
    stress = [real(DP) :: 3, -2, 1, 0, 0, 0]
    call cut_principal_stresses(-1, .false., .false., stress, tangent)
    call suite%near('no tension', norm2(stress - [real(DP) :: 0, -2, 0, 0, 0, 0]), 0.0_DP, 1.0e-13_DP)
    stress = [real(DP) :: 0, 0, 0, 2, 0, 0]        ! pure shear: half of it stays along the diagonal
    call cut_principal_stresses(1, .false., .false., stress, tangent)
    call suite%near('pure shear', norm2(stress - [real(DP) :: 1, 1, 0, 1, 0, 0]), 0.0_DP, 1.0e-13_DP)
    stress = [real(DP) :: 3, 2, 1, 0, 0, 0]
    tangent = 7
    call cut_principal_stresses(1, .false., .true., stress, tangent)
    call suite%that('what stays has its tangent', all(tangent == 7.0_DP) .and. all(stress == [real(DP) :: 3, 2, 1, 0, 0, 0]))
    stress = 0
    call cut_principal_stresses(-1, .false., .true., stress, tangent)
    call suite%that('at rest, too', all(tangent == 7.0_DP))
    call suite%that('a material without the cards has an energy', .not. has_no_energy(isotropic))
  end subroutine check_values


  !> Tangents, the sign of the principal stresses, energy and words of a material.
  subroutine check_material(name, material)
    character(*), intent(in) :: name
    type(material_type), intent(in) :: material
    character(:), allocatable :: words
    words = law_name(material)
    call suite%that('its name: ' // words, index(words, trim(merge('no compression', 'no tension    ', material%cutoff_sign &
      > 0))) > 0)
    call suite%that('it has no energy', has_no_energy(material))
    call check_tangent(name, material, STRAIN_A, .false.)
    call check_tangent(name, material, STRAIN_B, .false.)
    call check_tangent(name, material, 10 * STRAIN_A, .true.)
    call check_tangent(name, material, 10 * STRAIN_B, .true.)
    call check_rest(name, material)
  end subroutine check_material


  !> The tangent against differences of the stress; at finite strain L_v tau = c : d. No principal stress has the other sign.
  subroutine check_tangent(name, material, strain, is_nlgeom)
    character(*), intent(in) :: name
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: strain(6)
    logical, intent(in) :: is_nlgeom
    real(DP), parameter :: STEP = 1.0e-7_DP
    type(material_point_type) :: start, point, plus, minus
    real(DP) :: d(3, 3), c(6, 6), values(3), axes(3, 3), work
    integer :: k, status
    start%frame = IDENTITY
    start%temperature = 0
    start%initial_temperature = 0
    start%time = 0
    start%time_increment = 0
    start%history_old = 0
    start%strain = strain
    start%H = unpack_voigt(strain) + reshape([0.0_DP, 0.02_DP, -0.01_DP, -0.02_DP, 0.0_DP, 0.03_DP, 0.01_DP, -0.03_DP, 0.0_DP], &
      [3, 3])
    point = start
    call update_material_point(material, is_nlgeom, point, status)
    call suite%that(name // ': status', status == STRESS_OK)
    call symmetric_eigen(point%stress, values, axes)
    call suite%that(name // ': signs', all(material%cutoff_sign * nint(sign(1.0_DP, values)) > 0 .or. &
      abs(values) < 1.0e-12_DP * maxval(abs(values))))
    call suite%that(name // ': some are cut', any(abs(values) < 1.0e-12_DP * maxval(abs(values))))
    do k = 1, 6
      d = 0
      d(VOIGT_ROW(k), VOIGT_COLUMN(k)) = 0.5_DP * STEP
      d = d + transpose(d)
      plus = start
      minus = start
      plus%H = start%H + matmul(d, IDENTITY + start%H)
      minus%H = start%H - matmul(d, IDENTITY + start%H)
      plus%strain = start%strain + pack_voigt(d)
      minus%strain = start%strain - pack_voigt(d)
      call update_material_point(material, is_nlgeom, plus, status)
      call update_material_point(material, is_nlgeom, minus, status)
      c(:, k) = (plus%stress - minus%stress) / (2 * STEP)
      if (is_nlgeom) c(:, k) = c(:, k) - pack_voigt(matmul(d, unpack_voigt(point%stress)) &
        + matmul(unpack_voigt(point%stress), d)) / STEP
    end do
    call suite%near(name // ': tangent', maxval(abs(c - point%tangent)) / maxval(abs(c)), 0.0_DP, 10 * REMAINING)
    if (is_nlgeom) return
    work = 0.5_DP * (dot_product(point%stress(:3), strain(:3)) + 2 * dot_product(point%stress(4:), strain(4:)))
    call suite%near(name // ': work along a straight path', point%energy, work, 1.0e-12_DP * work)
  end subroutine check_tangent


  !> At rest the tangent is the elastic one.
  subroutine check_rest(name, material)
    character(*), intent(in) :: name
    type(material_type), intent(in) :: material
    type(material_type) :: elastic
    type(material_point_type) :: point, other
    integer :: status
    point%frame = IDENTITY
    point%temperature = 0
    point%initial_temperature = 0
    point%time = 0
    point%time_increment = 0
    point%history_old = 0
    point%strain = 0
    point%H = 0
    other = point
    elastic = material
    elastic%cutoff_sign = 0
    call update_material_point(material, .false., point, status)
    call update_material_point(elastic, .false., other, status)
    call suite%near(name // ': at rest', maxval(abs(point%tangent - other%tangent)), 0.0_DP, 0.0_DP)
  end subroutine check_rest

end program test_principal_stress_cutoff
