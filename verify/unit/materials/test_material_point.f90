!> Unit test of amontons_material_point: every law: tangent and energy by differences, objectivity, closed forms, paths.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_material_point
  use amontons_kinds, only: DP
  use amontons_materials, only: material_type, property_table_type, hardening_curve_type, LAW_HENCKY, LAW_SAINT_VENANT, &
    ELASTIC_ORTHOTROPIC, ELASTIC_ANISOTROPIC, ELASTIC_HYPER, ELASTIC_FOAM, HYPER_POLYNOMIAL, &
    HYPER_OGDEN, HYPER_ARRUDA_BOYCE, CREEP_TIME_HARDENING, CREEP_STRAIN_HARDENING, RATE_POWER, CONE_TENSION, &
    YIELD_RATIO, YIELD_MOHR_COULOMB, HISTORY_PEEQ, HISTORY_CEEQ, &
    HISTORY_INELASTIC
  use amontons_material_point, only: material_point_type, update_material_point, elastic_strain_from_stress
  use amontons_elasticity, only: small_strain_stress, finite_strain_stress, STRESS_OK, STRESS_INVERTED
  use amontons_tensor, only: IDENTITY, VOIGT_IDENTITY, VOIGT_ROW, VOIGT_COLUMN, pack_voigt, unpack_voigt, von_mises
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer :: n, i

  call random_seed(size=n)
  call random_seed(put=[(104729 * i, i=1, n)])
  call check_elastic_is_plain()
  call check_thermal()
  call check_tables()
  do i = 1, 9
    call check_rubber(rubber(i), i)
  end do
  call check_plastic(metal(), 'isotropic')
  call check_plastic(kinematic_metal(.false.), 'kinematic')
  call check_plastic(kinematic_metal(.true.), 'combined')
  call check_plastic(creeping(CREEP_TIME_HARDENING, 0.0_DP), 'creep')
  call check_plastic(creeping(CREEP_TIME_HARDENING, -0.4_DP), 'time hardening')
  call check_plastic(creeping(CREEP_STRAIN_HARDENING, -0.4_DP), 'strain hardening')
  call check_plastic(creeping_metal(), 'creep and yield')
  call check_plastic(fast_metal(metal()), 'yield at a rate')
  call check_plastic(fast_metal(crystal()), 'yield at a rate with cubic elasticity')
  call check_plastic(ramberg_osgood(), 'deformation plasticity')
  call check_plastic(crystal(), 'cubic elasticity')
  call check_plastic(isotropic_as_crystal(), 'isotropic by its matrix')
  call check_cone(20.0_DP, LAW_HENCKY)
  call check_cone(5.0_DP, LAW_HENCKY)
  call check_cone(0.0_DP, LAW_SAINT_VENANT)
  call check_lode_angle(YIELD_RATIO, 5.0_DP, LAW_HENCKY)
  call check_lode_angle(YIELD_RATIO, 20.0_DP, LAW_SAINT_VENANT)
  call check_lode_angle(YIELD_MOHR_COULOMB, 5.0_DP, LAW_SAINT_VENANT)
  call check_lode_angle(YIELD_MOHR_COULOMB, 20.0_DP, LAW_HENCKY)
  call check_same_flow()
  call check_simo(metal(), 'Simo, isotropic')
  call check_simo(kinematic_metal(.false.), 'Simo, kinematic')
  call check_simo(kinematic_metal(.true.), 'Simo, combined')
  call check_simo_tension()
  call check_almansi()
  call check_axes()
  call check_tension()
  call check_cycle()
  call check_zero_increments()
  call check_shared_finite_strain()
  call check_creep_closed_forms()
  call check_initial_stress()
  call check_simple_closed_forms()
  call suite%finish()

contains

  !> A material with E and nu.
  function elastic() result(material)
    type(material_type) :: material
    material%youngs_modulus = 210000
    material%poissons_ratio = 0.3_DP
    material%is_linear_isotropic = .false.
  end function elastic


  !> Isotropic hardening, with a curve that softens in its slope.
  function metal() result(material)
    type(material_type) :: material
    material = elastic()
    allocate (material%isotropic_hardening(1))
    material%isotropic_hardening(1) = hardening_curve_type(0.0_DP, [0.0_DP, 0.05_DP, 0.3_DP], [240.0_DP, 400.0_DP, 600.0_DP])
  end function metal


  !> Kinematic hardening, or combined.
  function kinematic_metal(is_combined) result(material)
    logical, intent(in) :: is_combined
    type(material_type) :: material
    material = elastic()
    allocate (material%kinematic_hardening(1))
    material%kinematic_hardening(1) = hardening_curve_type(0.0_DP, [0.0_DP, 0.1_DP], [240.0_DP, 1240.0_DP])
    if (.not. is_combined) return
    allocate (material%isotropic_hardening(1))
    material%isotropic_hardening(1) = hardening_curve_type(0.0_DP, [0.0_DP, 0.2_DP], [240.0_DP, 340.0_DP])
  end function kinematic_metal


  !> Power-law creep.
  function creeping(law, m) result(material)
    integer, intent(in) :: law
    real(DP), intent(in) :: m
    type(material_type) :: material
    material = elastic()
    material%creep_law = law
    material%creep = property_table_type([0.0_DP], reshape([1.0e-14_DP, 4.5_DP, m], [3, 1]))
  end function creeping


  !> Creep and plasticity together.
  function creeping_metal() result(material)
    type(material_type) :: material
    material = metal()
    material%creep_law = CREEP_TIME_HARDENING
    material%creep = property_table_type([0.0_DP], reshape([1.0e-13_DP, 4.0_DP, 0.0_DP], [3, 1]))
  end function creeping_metal


  !> A metal whose yield stress depends on the rate of plastic strain.
  function fast_metal(static) result(material)
    type(material_type), intent(in) :: static
    type(material_type) :: material
    material = static
    material%rate_law = RATE_POWER
    material%rate_power = property_table_type([0.0_DP], reshape([0.1_DP, 4.0_DP], [2, 1]))
  end function fast_metal


  !> Deformation plasticity.
  function ramberg_osgood() result(material)
    type(material_type) :: material
    material = elastic()
    material%has_deformation_plasticity = .true.
    material%deformation_plasticity = property_table_type([0.0_DP], reshape([210000.0_DP, 0.3_DP, 300.0_DP, 8.0_DP, 0.4_DP], [5, &
      1]))
  end function ramberg_osgood


  !> Plasticity with cubic elasticity.
  function crystal() result(material)
    type(material_type) :: material
    material = metal()
    material%elastic_kind = ELASTIC_ORTHOTROPIC
    call give(material, [230000.0_DP, 130000.0_DP, 230000.0_DP, 130000.0_DP, 130000.0_DP, 230000.0_DP, 110000.0_DP, &
      110000.0_DP, 110000.0_DP])
  end function crystal


  !> Plasticity whose elasticity is isotropic, E = 210000, nu = 0.3, but given as a matrix.
  function isotropic_as_crystal() result(material)
    type(material_type) :: material
    real(DP), parameter :: G = 210000.0_DP / 2.6_DP, L = 210000.0_DP * 0.3_DP / (1.3_DP * 0.4_DP)
    material = metal()
    material%elastic_kind = ELASTIC_ORTHOTROPIC
    call give(material, [L + 2 * G, L, L + 2 * G, L, L, L + 2 * G, G, G, G])
  end function isotropic_as_crystal


  !> The flow of anisotropic elasticity is the radial return where the matrix is isotropic.
  subroutine check_same_flow()
    type(material_type) :: metals(2)
    type(material_point_type) :: point(2)
    integer :: i, k, status
    metals(1) = metal()
    metals(2) = isotropic_as_crystal()
    point = virgin()
    do i = 1, 4
      point(1)%strain = pack_voigt(any_gradient(0.02_DP))
      point(2)%strain = point(1)%strain
      do k = 1, 2
        call update_material_point(metals(k), .false., point(k), status)
        call suite%that('same flow: status', status == STRESS_OK)
      end do
      call suite%near('same flow: stress', maxval(abs(point(2)%stress - point(1)%stress)), 0.0_DP, &
        1e-9_DP * maxval(abs(point(1)%stress)))
      call suite%near('same flow: tangent', maxval(abs(point(2)%tangent - point(1)%tangent)), 0.0_DP, &
        1e-8_DP * maxval(abs(point(1)%tangent)))
      call suite%near('same flow: history', maxval(abs(point(2)%history - point(1)%history)), 0.0_DP, 1e-12_DP)
      point(1)%history_old = point(1)%history
      point(2)%history_old = point(2)%history
    end do
  end subroutine check_same_flow


  !> Rubbers and foams.
  function rubber(i) result(material)
    integer, intent(in) :: i
    type(material_type) :: material
    material%is_linear_isotropic = .false.
    material%elastic_kind = ELASTIC_HYPER
    material%hyper_kind = HYPER_POLYNOMIAL
    material%hyper_order = 1
    select case (i)
    case (1)                                       ! neo-Hooke
      call give(material, [0.5_DP, 0.0_DP, 0.1_DP])
    case (2)                                       ! Mooney-Rivlin
      call give(material, [0.5_DP, 0.2_DP, 0.1_DP])
    case (3)                                       ! Yeoh
      material%hyper_order = 3
      call give(material, [0.5_DP, 0.0_DP, -0.01_DP, 0.0_DP, 0.0_DP, 0.003_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.1_DP, 0.2_DP, &
        0.0_DP])
    case (4)                                       ! polynomial, second order
      material%hyper_order = 2
      call give(material, [0.5_DP, 0.2_DP, 0.03_DP, -0.02_DP, 0.04_DP, 0.1_DP, 0.3_DP])
    case (5)                                       ! polynomial, third order
      material%hyper_order = 3
      call give(material, [0.5_DP, 0.2_DP, 0.03_DP, -0.02_DP, 0.04_DP, 0.005_DP, 0.002_DP, 0.003_DP, 0.001_DP, &
        0.1_DP, 0.3_DP, 0.5_DP])
    case (6)                                       ! Ogden
      material%hyper_kind = HYPER_OGDEN
      material%hyper_order = 3
      call give(material, [0.63_DP, 1.3_DP, 0.0012_DP, 5.0_DP, -0.01_DP, -2.0_DP, 0.1_DP, 0.0_DP, 0.4_DP])
    case (7)                                       ! Arruda-Boyce
      material%hyper_kind = HYPER_ARRUDA_BOYCE
      call give(material, [0.8_DP, 2.5_DP, 0.1_DP])
    case (8)                                       ! foam
      material%elastic_kind = ELASTIC_FOAM
      material%hyper_order = 2
      call give(material, [0.7_DP, 4.0_DP, 0.2_DP, -2.0_DP, 0.1_DP, 0.25_DP])
    case (9)                                       ! foam without lateral effect
      material%elastic_kind = ELASTIC_FOAM
      call give(material, [0.7_DP, 4.0_DP, 0.0_DP])
    end select
  end function rubber


  !> Constants without temperature.
  subroutine give(material, constants)
    type(material_type), intent(inout) :: material
    real(DP), intent(in) :: constants(:)
    material%elastic = property_table_type([0.0_DP], reshape(constants, [size(constants), 1]))
  end subroutine give


  !> A point at rest, before its first increment.
  function virgin() result(point)
    type(material_point_type) :: point
    point%H = 0
    point%strain = 0
    point%frame = IDENTITY
    point%temperature = 0
    point%initial_temperature = 0
    point%time = 1
    point%time_increment = 1
    point%elapsed_time = 1
    point%history_old = 0
  end function virgin


  !> A random displacement gradient.
  function any_gradient(size) result(H)
    real(DP), intent(in) :: size
    real(DP) :: H(3, 3)
    call random_number(H)
    H = size * (2 * H - 1)
  end function any_gradient


  !> A rotation by random angles.
  function any_rotation() result(R)
    real(DP) :: R(3, 3), a(3)
    call random_number(a)
    a = 6 * a
    R = reshape([cos(a(1)), sin(a(1)), 0.0_DP, -sin(a(1)), cos(a(1)), 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [3, 3])
    R = matmul(R, reshape([1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, cos(a(2)), sin(a(2)), 0.0_DP, -sin(a(2)), cos(a(2))], &
      [3, 3]))
  end function any_rotation


  !> The tangent against central differences of the stress, small or finite; at finite strain L_v tau = c : d.
  subroutine check_tangent(name, material, start, is_nlgeom, tolerance, has_potential)
    character(*), intent(in) :: name
    type(material_type), intent(in) :: material
    type(material_point_type), intent(in) :: start
    logical, intent(in) :: is_nlgeom
    real(DP), intent(in) :: tolerance              !< over the largest entry [-]
    logical, intent(in), optional :: has_potential   !< .false.: the tangent is the symmetric part
    type(material_point_type) :: point, plus, minus
    real(DP) :: d(3, 3), c(6, 6), F(3, 3), scale
    real(DP), parameter :: STEP = 1.0e-6_DP
    integer :: k, status, status_plus, status_minus
    point = start
    call update_material_point(material, is_nlgeom, point, status)
    call suite%that(name // ': status', status == STRESS_OK)
    F = IDENTITY + start%H
    do k = 1, 6
      d = 0
      d(VOIGT_ROW(k), VOIGT_COLUMN(k)) = 0.5_DP * STEP
      d = d + transpose(d)                         ! engineering shear STEP, or normal strain STEP
      plus = start
      minus = start
      plus%H = start%H + matmul(d, F)
      minus%H = start%H - matmul(d, F)
      plus%strain = start%strain + pack_voigt(d)
      minus%strain = start%strain - pack_voigt(d)
      call update_material_point(material, is_nlgeom, plus, status_plus)
      call update_material_point(material, is_nlgeom, minus, status_minus)
      c(:, k) = (plus%stress - minus%stress) / (2 * STEP)
      if (is_nlgeom) c(:, k) = c(:, k) - pack_voigt(matmul(d, unpack_voigt(point%stress)) &
        + matmul(unpack_voigt(point%stress), d)) / STEP
    end do
    if (present(has_potential)) c = 0.5_DP * (c + transpose(c))
    scale = max(maxval(abs(c)), 1.0_DP)            ! 0 at an apex
    call suite%near(name // ': tangent', maxval(abs(c - point%tangent)) / scale, 0.0_DP, tolerance)
    if (material%is_unsymmetric) return
    call suite%near(name // ': symmetric', maxval(abs(point%tangent - transpose(point%tangent))) / maxval(abs(c)), &
      0.0_DP, 1e-12_DP)
  end subroutine check_tangent


  !> The stress is the derivative of the energy: d energy = tau : d.
  subroutine check_energy(name, material, start, tolerance)
    character(*), intent(in) :: name
    type(material_type), intent(in) :: material
    type(material_point_type), intent(in) :: start
    real(DP), intent(in) :: tolerance
    type(material_point_type) :: point, plus, minus
    real(DP) :: d(3, 3), t(6)
    real(DP), parameter :: STEP = 1.0e-6_DP
    integer :: k, status
    point = start
    call update_material_point(material, .true., point, status)
    do k = 1, 6
      d = 0
      d(VOIGT_ROW(k), VOIGT_COLUMN(k)) = 0.5_DP * STEP
      d = d + transpose(d)
      plus = start
      minus = start
      plus%H = start%H + matmul(d, IDENTITY + start%H)
      minus%H = start%H - matmul(d, IDENTITY + start%H)
      call update_material_point(material, .true., plus, status)
      call update_material_point(material, .true., minus, status)
      t(k) = (plus%energy - minus%energy) / (2 * STEP)
    end do
    call suite%near(name // ': energy', maxval(abs(t - point%stress)) / maxval(abs(t)), 0.0_DP, tolerance)
  end subroutine check_energy


  !> A superposed rotation rotates the stress and leaves energy and history unchanged.
  subroutine check_objectivity(name, material, start)
    character(*), intent(in) :: name
    type(material_type), intent(in) :: material
    type(material_point_type), intent(in) :: start
    type(material_point_type) :: point, turned
    real(DP) :: R(3, 3), expected(6)
    integer :: status
    point = start
    turned = start
    R = any_rotation()
    turned%H = matmul(R, IDENTITY + start%H) - IDENTITY
    call update_material_point(material, .true., point, status)
    call update_material_point(material, .true., turned, status)
    expected = pack_voigt(matmul(R, matmul(unpack_voigt(point%stress), transpose(R))))
    call suite%near(name // ': turned stress', maxval(abs(turned%stress - expected)) / maxval(abs(expected)), 0.0_DP, &
      1e-10_DP)
    call suite%near(name // ': turned history', maxval(abs(turned%history(:8) - point%history(:8))), 0.0_DP, 1e-12_DP)
  end subroutine check_objectivity


  !> Without table, temperature and history the general law equals plain elasticity.
  subroutine check_elastic_is_plain()
    type(material_type) :: material
    type(material_point_type) :: point
    real(DP) :: stress(6), c(6, 6), strain(6), energy
    integer :: law, status
    material = elastic()
    do law = LAW_HENCKY, LAW_SAINT_VENANT
      material%law = law
      point = virgin()
      point%H = any_gradient(0.4_DP)
      call update_material_point(material, .true., point, status)
      call finite_strain_stress(material, point%H, stress, c, strain, energy, status)
      call suite%near('plain: stress', maxval(abs(point%stress - stress)) / maxval(abs(stress)), 0.0_DP, 1e-13_DP)
      call suite%near('plain: tangent', maxval(abs(point%tangent - c)) / maxval(abs(c)), 0.0_DP, 1e-13_DP)
      call suite%near('plain: strain', maxval(abs(point%strain - strain)), 0.0_DP, 1e-14_DP)
      call suite%near('plain: energy', point%energy / energy, 1.0_DP, 1e-13_DP)
    end do
    point = virgin()
    call random_number(point%strain)
    call update_material_point(material, .false., point, status)
    call small_strain_stress(material, point%strain, stress, c, energy)
    call suite%near('plain, small: stress', maxval(abs(point%stress - stress)), 0.0_DP, 1e-9_DP)
    call suite%near('plain, small: energy', point%energy / energy, 1.0_DP, 1e-13_DP)
    point = virgin()
    point%H(1, 1) = -1.5_DP
    call update_material_point(material, .true., point, status)
    call suite%that('inverted', status == STRESS_INVERTED)
  end subroutine check_elastic_is_plain


  !> Free thermal expansion has zero stress; restrained expansion has E a dT/(1 - 2 nu).
  subroutine check_thermal()
    type(material_type) :: material
    type(material_point_type) :: point
    integer :: status
    material = elastic()
    material%expansion = property_table_type([0.0_DP, 100.0_DP], reshape([1.0e-5_DP, 2.0e-5_DP], [1, 2]))
    material%expansion_reference = 20
    point = virgin()
    point%initial_temperature = 50
    point%temperature = 100
    point%strain = (2.0e-5_DP * 80 - 1.5e-5_DP * 30) * VOIGT_IDENTITY
    call update_material_point(material, .false., point, status)
    call suite%near('thermal: free', maxval(abs(point%stress)), 0.0_DP, 1e-9_DP)
    point%strain = 0
    call update_material_point(material, .false., point, status)
    call suite%near('thermal: held', point%stress(2), -210000 / 0.4_DP * 1.15e-3_DP, 1e-9_DP)
    point%H = (exp(1.15e-3_DP) - 1) * IDENTITY
    call update_material_point(material, .true., point, status)
    call suite%near('thermal: free, finite', maxval(abs(point%stress)), 0.0_DP, 1e-9_DP)
    point%H = any_gradient(0.2_DP)
    call check_tangent('thermal', material, point, .true., 1e-8_DP)
    material%expansion = property_table_type([0.0_DP], reshape([1.0e-5_DP, 2.0e-5_DP, 3.0e-5_DP], [3, 1]))
    material%expansion_reference = 0
    point = virgin()
    point%temperature = 100
    point%frame = reshape([0.0_DP, 1.0_DP, 0.0_DP, -1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [3, 3])
    point%strain = [2.0e-3_DP, 1.0e-3_DP, 3.0e-3_DP, 0.0_DP, 0.0_DP, 0.0_DP]
    call update_material_point(material, .false., point, status)
    call suite%near('thermal: along axes', maxval(abs(point%stress)), 0.0_DP, 1e-9_DP)
  end subroutine check_thermal


  !> Constants between two temperatures.
  subroutine check_tables()
    type(material_type) :: material
    type(material_point_type) :: point
    integer :: status
    material = elastic()
    material%elastic = property_table_type([0.0_DP, 100.0_DP], reshape([200000.0_DP, 0.0_DP, 100000.0_DP, 0.0_DP], [2, 2]))
    point = virgin()
    point%strain(1) = 1.0e-3_DP
    point%temperature = 25
    call update_material_point(material, .false., point, status)
    call suite%near('table: between', point%stress(1), 175.0_DP, 1e-9_DP)
    point%temperature = 200
    call update_material_point(material, .false., point, status)
    call suite%near('table: beyond', point%stress(1), 100.0_DP, 1e-9_DP)
    material = metal()
    deallocate (material%isotropic_hardening)
    allocate (material%isotropic_hardening(2))
    material%isotropic_hardening(1) = hardening_curve_type(0.0_DP, [0.0_DP], [200.0_DP])
    material%isotropic_hardening(2) = hardening_curve_type(100.0_DP, [0.0_DP], [100.0_DP])
    point = virgin()
    point%temperature = 50
    point%strain = 0.1_DP * [real(DP) :: 2, -1, -1, 0, 0, 0]
    call update_material_point(material, .false., point, status)
    call suite%near('table: yield stress', von_mises(point%stress), 150.0_DP, 1e-9_DP)
  end subroutine check_tables


  !> Rubber and foam: tangent, energy, objectivity, equal stretches, tiny strains, small displacements.
  subroutine check_rubber(material, number)
    type(material_type), intent(in) :: material
    integer, intent(in) :: number
    type(material_point_type) :: point, tiny_point
    character(9) :: name
    integer :: status
    write (name, '(a,i0)') 'rubber ', number
    point = virgin()
    point%H = any_gradient(0.5_DP)
    call check_tangent(name, material, point, .true., 1e-7_DP)
    call check_energy(name, material, point, 1e-7_DP)
    call check_objectivity(name, material, point)
    point%H = 0.3_DP * IDENTITY
    call check_tangent(name // ' swollen', material, point, .true., 1e-7_DP)
    point%H(1, 1) = 0.3_DP + 1e-9_DP
    call check_tangent(name // ' nearly swollen', material, point, .true., 1e-7_DP)
    point%H = 0
    point%strain = 0
    call update_material_point(material, .true., point, status)
    tiny_point = virgin()
    tiny_point%H = any_gradient(1.0e-9_DP)
    tiny_point%strain = pack_voigt(tiny_point%H)
    call update_material_point(material, .true., tiny_point, status)
    tiny_point%strain(4:) = 2 * tiny_point%strain(4:)
    call suite%near(name // ': tiny strain', maxval(abs(matmul(point%tangent, tiny_point%strain) - tiny_point%stress)) &
      / maxval(abs(tiny_point%stress)), 0.0_DP, 1e-7_DP)
    tiny_point%strain = pack_voigt(tiny_point%H)
    call update_material_point(material, .false., tiny_point, status)
    call suite%near(name // ': small displacements', maxval(abs(tiny_point%tangent - point%tangent)) &
      / maxval(abs(point%tangent)), 0.0_DP, 1e-13_DP)
  end subroutine check_rubber


  !> Plasticity and creep over some increments, small and finite: tangents, objectivity, plastic incompressibility.
  subroutine check_plastic(material, name)
    type(material_type), intent(in) :: material
    character(*), intent(in) :: name
    type(material_point_type) :: point
    integer :: i, status
    point = virgin()
    do i = 1, 4
      point%strain = pack_voigt(any_gradient(0.02_DP))
      point%time = real(i, DP)
      call check_tangent(name // ', small', material, point, .false., 1e-6_DP)
      call update_material_point(material, .false., point, status)
      point%history_old = point%history
    end do
    call suite%near(name // ', small: no volume', sum(point%history_old(HISTORY_INELASTIC:HISTORY_INELASTIC + 2)), 0.0_DP, &
      1e-15_DP)
    point = virgin()
    do i = 1, 4
      point%H = any_gradient(0.3_DP)
      point%time = real(i, DP)
      call check_tangent(name // ', finite', material, point, .true., 1e-6_DP)
      call check_objectivity(name, material, point)
      call update_material_point(material, .true., point, status)
      point%history_old = point%history
    end do
    call suite%near(name // ', finite: no volume', sum(point%history_old(HISTORY_INELASTIC:HISTORY_INELASTIC + 2)), 0.0_DP, &
      1e-13_DP)
    if (.not. material%has_deformation_plasticity) call suite%that(name // ': has yielded', &
      point%history_old(HISTORY_PEEQ) + point%history_old(HISTORY_CEEQ) > 0.01_DP)
  end subroutine check_plastic


  !> The cone of Drucker and Prager over some increments, small and finite, on the cone and at its apex: tangents, objectivity and
  !! the direction of flow: on the cone the volume grows by c tan(psi) of the equivalent plastic strain.
  subroutine check_cone(dilation, law)
    real(DP), intent(in) :: dilation               !< [degree]
    integer, intent(in) :: law                     !< LAW_...
    type(material_type) :: material
    type(material_point_type) :: point
    real(DP), parameter :: DEGREE = acos(-1.0_DP) / 180, FRICTION = 20
    real(DP) :: volume, growth
    integer :: i, n_cone, n_apex, status
    logical :: is_nlgeom
    material = metal()
    material%law = law
    material%cone = property_table_type([0.0_DP], reshape(DEGREE * [FRICTION, dilation], [2, 1]))
    material%cone_hardening = CONE_TENSION
    material%is_unsymmetric = dilation < FRICTION
    n_cone = 0
    n_apex = 0
    growth = tan(DEGREE * dilation) / (1 + tan(DEGREE * dilation) / 3)
    do i = 0, 23
      is_nlgeom = i >= 12
      if (mod(i, 6) == 0) point = virgin()
      point%H = any_gradient(0.02_DP)
      if (mod(i, 3) == 2) point%H = point%H + 0.02_DP * IDENTITY
      point%strain = pack_voigt(point%H)
      call check_tangent('cone', material, point, is_nlgeom, 1e-5_DP)
      if (is_nlgeom) call check_objectivity('cone', material, point)
      call update_material_point(material, is_nlgeom, point, status)
      volume = sum(point%history(HISTORY_INELASTIC:HISTORY_INELASTIC + 2)) &
        - sum(point%history_old(HISTORY_INELASTIC:HISTORY_INELASTIC + 2))
      if (von_mises(point%stress) > 1e-6_DP) then
        n_cone = n_cone + merge(1, 0, point%history(HISTORY_PEEQ) > point%history_old(HISTORY_PEEQ))
        call suite%near('cone: dilation', volume, growth * (point%history(HISTORY_PEEQ) - point%history_old(HISTORY_PEEQ)), &
          1e-13_DP)
      else
        n_apex = n_apex + 1
      end if
      point%history_old = point%history
    end do
    call suite%that('cone: has flowed on the cone and at the apex', n_cone > 3 .and. n_apex > 3)
  end subroutine check_cone


  !> Laws of the Lode angle over some increments, small and finite: tangents, objectivity, and the volume that grows by flow.
  subroutine check_lode_angle(yield_surface, dilation, law)
    integer, intent(in) :: yield_surface           !< YIELD_...
    real(DP), intent(in) :: dilation               !< [degree]
    integer, intent(in) :: law                     !< LAW_...
    type(material_type) :: material
    type(material_point_type) :: point
    real(DP), parameter :: DEGREE = acos(-1.0_DP) / 180, FRICTION = 20
    real(DP) :: volume
    integer :: i, n_flow, status
    logical :: is_nlgeom
    material = metal()
    material%law = law
    material%yield_surface = yield_surface
    material%cone = property_table_type([0.0_DP], reshape([DEGREE * FRICTION, DEGREE * dilation, 0.8_DP, 0.1_DP], [4, 1]))
    material%cone_hardening = CONE_TENSION
    material%is_unsymmetric = dilation < FRICTION .or. yield_surface == YIELD_MOHR_COULOMB
    n_flow = 0
    do i = 0, 23
      is_nlgeom = i >= 12
      if (mod(i, 6) == 0) point = virgin()
      point%H = any_gradient(0.02_DP)
      if (mod(i, 3) == 2) point%H = point%H + 0.02_DP * IDENTITY
      point%strain = pack_voigt(point%H)
      call check_tangent('Lode angle', material, point, is_nlgeom, 1e-5_DP)
      if (is_nlgeom) call check_objectivity('Lode angle', material, point)
      call update_material_point(material, is_nlgeom, point, status)
      if (point%history(HISTORY_PEEQ) > point%history_old(HISTORY_PEEQ)) n_flow = n_flow + 1
      volume = sum(point%history(HISTORY_INELASTIC:HISTORY_INELASTIC + 2)) - &
        sum(point%history_old(HISTORY_INELASTIC:HISTORY_INELASTIC + 2))
      if (point%history(HISTORY_PEEQ) > point%history_old(HISTORY_PEEQ)) call suite%that('Lode angle: volume', volume > 0)
      point%history_old = point%history
    end do
    call suite%that('Lode angle: has flowed', n_flow > 12)
  end subroutine check_lode_angle


  !> Simo's plasticity: objectivity, a tangent accurate to the order of the elastic strains, exact without flow.
  subroutine check_simo(simo, name)
    type(material_type), intent(in) :: simo
    character(*), intent(in) :: name
    type(material_type) :: material
    type(material_point_type) :: point
    integer :: i, status
    material = simo
    material%law = LAW_SAINT_VENANT
    point = virgin()
    do i = 1, 4
      point%H = any_gradient(0.05_DP)
      call check_tangent(name, material, point, .true., 0.03_DP)
      call check_objectivity(name, material, point)
      call update_material_point(material, .true., point, status)
      point%history_old = point%history
    end do
    call suite%that(name // ': has yielded', point%history_old(HISTORY_PEEQ) > 0.01_DP)
    if (allocated(material%isotropic_hardening)) material%isotropic_hardening(1)%stress = 3 * material%isotropic_hardening(1)%stress
    if (allocated(material%kinematic_hardening)) material%kinematic_hardening(1)%stress = 3 * material%kinematic_hardening(1)%stress
    call check_tangent(name // ', within the yield surface', material, point, .true., 1e-7_DP)
  end subroutine check_simo


  !> Deformation plasticity under the calculix dialect: objectivity, tangent, and the stress of CalculiX 2.20, one C3D8 that is
  !! sheared symmetrically by 0.001: 1.134923e2 in the plane, normal stresses -0.5817470 and -0.4115086.
  subroutine check_almansi()
    type(material_type) :: material
    type(material_point_type) :: point
    integer :: i, status
    material = ramberg_osgood()
    material%law = LAW_SAINT_VENANT
    do i = 1, 4
      point = virgin()
      point%H = any_gradient(0.1_DP)
      call check_tangent('Almansi', material, point, .true., 1e-6_DP, has_potential=.false.)
      call check_objectivity('Almansi', material, point)
    end do
    material%deformation_plasticity = property_table_type([0.0_DP], reshape([210000.0_DP, 0.3_DP, 200.0_DP, 6.0_DP, 0.4_DP], [5, &
      1]))
    point = virgin()
    point%H(1, 2) = 1e-3_DP
    point%H(2, 1) = 1e-3_DP
    call update_material_point(material, .true., point, status)
    point%stress = point%stress / (1 - 1e-6_DP)    ! Cauchy's
    call suite%near('Almansi, shear', point%stress(4), 113.4923_DP, 1e-4_DP)
    call suite%near('Almansi, along', point%stress(1), -0.5817470_DP, 1e-6_DP)
    call suite%near('Almansi, across', point%stress(3), -0.4115086_DP, 1e-6_DP)
    call suite%near('Almansi, strain', point%strain(1), -1.500003e-6_DP, 1e-11_DP)
  end subroutine check_almansi


  !> Tension and compression by 2 % in 20 increments against CalculiX 2.20, one C3D8 with the same data: stress, PEEQ and
  !! lateral displacement.
  subroutine check_simo_tension()
    type(material_type) :: material
    real(DP), parameter :: STRETCH(3) = [0.02_DP, -0.02_DP, 0.02_DP]
    real(DP), parameter :: STRESS(3) = [923.7348_DP, -925.8352_DP, 924.6346_DP]
    real(DP), parameter :: PEEQ(3) = [1.546685e-2_DP, 1.572940e-2_DP, 1.546261e-2_DP]
    real(DP), parameter :: ACROSS(3) = [-8.980994e-3_DP, 9.262238e-3_DP, -8.980145e-3_DP]
    type(material_point_type) :: point
    integer :: i, k, n, status
    do k = 1, 3
      material = elastic()
      material%law = LAW_SAINT_VENANT
      if (k < 3) allocate (material%isotropic_hardening(1))
      if (k < 3) material%isotropic_hardening(1) = hardening_curve_type(0.0_DP, [0.0_DP, 0.1_DP], [800.0_DP, 1600.0_DP])
      if (k == 3) allocate (material%kinematic_hardening(1))
      if (k == 3) material%kinematic_hardening(1) = hardening_curve_type(0.0_DP, [0.0_DP, 0.1_DP], [800.0_DP, 1600.0_DP])
      point = virgin()
      do i = 1, 20
        point%H(1, 1) = STRETCH(k) * real(i, DP) / 20
        do n = 1, 30
          call update_material_point(material, .true., point, status)
          point%H(2, 2) = point%H(2, 2) - point%stress(2) / (point%tangent(2, 2) + point%tangent(2, 3))
          point%H(3, 3) = point%H(2, 2)
        end do
        call update_material_point(material, .true., point, status)
        point%history_old = point%history
      end do
      call suite%near('as CalculiX: stress', point%stress(1) / ((1 + point%H(1, 1)) * (1 + point%H(2, 2))**2), &
        STRESS(k), 2e-2_DP)
      call suite%near('as CalculiX: PEEQ', point%history(HISTORY_PEEQ), PEEQ(k), 1e-8_DP)
      call suite%near('as CalculiX: across', point%H(2, 2), ACROSS(k), 2e-8_DP)
    end do
  end subroutine check_simo_tension


  !> Orthotropic and anisotropic elasticity: tangents, objectivity in both finite laws; the material axes rotate with the frame.
  subroutine check_axes()
    type(material_type) :: material, full
    type(material_point_type) :: point, turned
    real(DP) :: R(3, 3), constants(21)
    integer :: law, status
    material = elastic()
    material%elastic_kind = ELASTIC_ORTHOTROPIC
    material%elastic = property_table_type([0.0_DP], reshape([500.0_DP, 100.0_DP, 400.0_DP, 80.0_DP, 60.0_DP, 300.0_DP, &
      90.0_DP, 70.0_DP, 50.0_DP], [9, 1]))
    do law = LAW_HENCKY, LAW_SAINT_VENANT
      material%law = law
      point = virgin()
      point%frame = any_rotation()
      point%H = any_gradient(0.3_DP)
      call check_tangent('axes', material, point, .true., 1e-7_DP)
      call check_energy('axes', material, point, 1e-6_DP)
      call check_objectivity('axes', material, point)
      point%H = 0.2_DP * IDENTITY
      call check_tangent('axes, swollen', material, point, .true., 1e-7_DP)
      point%H(2, 2) = 0.2_DP + 1e-7_DP
      call check_tangent('axes, nearly swollen', material, point, .true., 1e-7_DP)
    end do
    point = virgin()
    call random_number(point%strain)
    R = any_rotation()
    turned = point
    turned%frame = R
    turned%strain = pack_voigt(matmul(R, matmul(unpack_voigt(point%strain), transpose(R))))
    call update_material_point(material, .false., point, status)
    call update_material_point(material, .false., turned, status)
    call suite%near('axes: turned', maxval(abs(turned%stress - pack_voigt(matmul(R, &
      matmul(unpack_voigt(point%stress), transpose(R)))))), 0.0_DP, 1e-10_DP)
    call suite%near('axes: shear 13', point%stress(6), 2 * 70 * point%strain(6), 1e-12_DP)
    call suite%near('axes: shear 23', point%stress(5), 2 * 50 * point%strain(5), 1e-12_DP)
    full = material
    full%elastic_kind = ELASTIC_ANISOTROPIC
    constants = 0
    constants(:6) = material%elastic%value(:6, 1)
    constants([10, 15, 21]) = material%elastic%value(7:9, 1)
    full%elastic = property_table_type([0.0_DP], reshape(constants, [21, 1]))
    turned = point
    call update_material_point(full, .false., turned, status)
    call suite%near('axes: 21 constants', maxval(abs(turned%stress - point%stress)), 0.0_DP, 1e-12_DP)
    full%elastic%value(7, 1) = 11                  ! D1112
    call update_material_point(full, .false., turned, status)
    call suite%near('axes: coupling', turned%stress(1) - point%stress(1), 22 * point%strain(4), 1e-12_DP)
  end subroutine check_axes


  !> Tension beyond yield: stress on the curve, PEEQ = strain - stress/E; the same by one increment or many.
  subroutine check_tension()
    type(material_type) :: material
    type(material_point_type) :: point
    real(DP) :: strain, across, p
    integer :: i, status
    material = metal()
    p = 0.02_DP
    strain = p + (240 + 3200 * p) / 210000
    across = -0.3_DP * (strain - p) - 0.5_DP * p   ! elastic by nu, plastic by 1/2
    point = virgin()
    do i = 1, 2
      point%strain = [strain, across, across, 0.0_DP, 0.0_DP, 0.0_DP]
      if (i == 2) point%strain = 0.5_DP * point%strain
      call update_material_point(material, .false., point, status)
      if (i == 1) then
        call suite%near('tension: stress', point%stress(1), 240 + 3200 * p, 1e-9_DP)
        call suite%near('tension: lateral', maxval(abs(point%stress(2:))), 0.0_DP, 1e-9_DP)
        call suite%near('tension: PEEQ', point%history(HISTORY_PEEQ), p, 1e-14_DP)
        point%history_old = point%history
      end if
    end do
    call suite%near('tension: unloading is elastic', point%history(HISTORY_PEEQ), p, 0.1_DP)
  end subroutine check_tension


  !> A cycle in shear: isotropic hardening yields in reverse at the stress reached, kinematic at that less twice the
  !! first yield stress.
  subroutine check_cycle()
    type(material_type) :: material
    type(material_point_type) :: point
    real(DP) :: q_top, q_yield
    integer :: k, status
    do k = 1, 2
      material = metal()
      if (k == 2) material = kinematic_metal(.false.)
      point = virgin()
      point%strain(4) = 0.01_DP
      call update_material_point(material, .false., point, status)
      q_top = sqrt(3.0_DP) * point%stress(4)
      point%history_old = point%history
      q_yield = -q_top
      if (k == 2) q_yield = q_top - 480
      call probe(material, point, q_yield - q_top + 1e-6_DP, .true.)
      call probe(material, point, q_yield - q_top - 1e-2_DP, .false.)
    end do
  end subroutine check_cycle


  !> Continues in shear by a stress change, and checks whether it is elastic.
  subroutine probe(material, start, dq, is_elastic)
    type(material_type), intent(in) :: material
    type(material_point_type), intent(in) :: start
    real(DP), intent(in) :: dq                     !< change of the von Mises stress [stress]
    logical, intent(in) :: is_elastic
    type(material_point_type) :: point
    integer :: status
    point = start
    point%strain(4) = point%strain(4) + dq / sqrt(3.0_DP) / (2 * 210000 / 2.6_DP)
    call update_material_point(material, .false., point, status)
    call suite%that('cycle: yield on the way back', &
      (point%history(HISTORY_PEEQ) <= point%history_old(HISTORY_PEEQ)) .eqv. is_elastic)
  end subroutine probe


  !> A state on the yield surface is unchanged: rounding must not make the return fail.
  subroutine check_zero_increments()
    type(material_type) :: material
    type(material_point_type) :: point, again
    integer :: i, k, status
    do k = 1, 2
      material = metal()
      if (k == 2) material = kinematic_metal(.true.)
      do i = 1, 200
        point = virgin()
        point%H = any_gradient(0.05_DP)
        call update_material_point(material, .true., point, status)
        again = point
        again%history_old = point%history
        call update_material_point(material, .true., again, status)
        if (status /= STRESS_OK) exit
        if (maxval(abs(again%history - point%history)) > 1e-9_DP * maxval(abs(point%history))) exit
      end do
      call suite%that('zero increments on the yield surface', i > 200)
    end do
  end subroutine check_zero_increments


  !> Finite strain without rotation of the axes: the multiplicative and the additive formulation agree, isotropic or kinematic in
  !! one direction; and history is the same in small and finite strain.
  subroutine check_shared_finite_strain()
    type(material_type) :: material, linear
    type(material_point_type) :: point, other
    integer :: i, status
    material = metal()
    linear = kinematic_metal(.false.)
    deallocate (material%isotropic_hardening)
    allocate (material%isotropic_hardening(1))
    material%isotropic_hardening = linear%kinematic_hardening
    point = virgin()
    other = virgin()
    do i = 1, 5
      point%H(1, 1) = 0.1_DP * real(i, DP)
      point%H(2, 2) = -0.03_DP * real(i, DP)
      point%H(3, 3) = -0.05_DP * real(i, DP)
      other%H = point%H
      call update_material_point(material, .true., point, status)
      call update_material_point(linear, .true., other, status)
      call suite%near('finite: two ways, PEEQ', point%history(HISTORY_PEEQ) / other%history(HISTORY_PEEQ), 1.0_DP, &
        1e-2_DP)
      if (i == 1) call suite%near('finite: two ways, stress', maxval(abs(point%stress - other%stress)) / &
        maxval(abs(point%stress)), 0.0_DP, 1e-12_DP)
      if (i == 1) call suite%near('finite: two ways, history', maxval(abs(point%history(:8) - other%history(:8))), &
        0.0_DP, 1e-13_DP)
      point%history_old = point%history
      other%history_old = other%history
    end do
    material = metal()
    point = virgin()
    point%strain = 1e-6_DP * 2000 * [real(DP) :: 2, -1, -1, 0, 0, 0]
    call update_material_point(material, .false., point, status)
    point%history_old = point%history
    other = point
    point%H = unpack_voigt(point%strain)
    call update_material_point(material, .true., point, status)
    call suite%near('history of small strain under NLGEOM', maxval(abs(point%stress - other%stress)) / &
      maxval(abs(other%stress)), 0.0_DP, 2e-2_DP)
  end subroutine check_shared_finite_strain


  !> Relaxation at constant strain, power law n = 4.5: q^(1 - n) = q0^(1 - n) + 3 G A (n - 1) t; and creep under constant stress
  !! by strain hardening: the same as time hardening.
  subroutine check_creep_closed_forms()
    type(material_type) :: material
    type(material_point_type) :: point
    real(DP) :: G, q0, q, c
    integer :: i, status
    integer, parameter :: STEPS = 4000
    G = 210000 / 2.6_DP
    material = creeping(CREEP_TIME_HARDENING, 0.0_DP)
    point = virgin()
    point%strain(4) = 1.0e-3_DP
    q0 = sqrt(3.0_DP) * 2 * G * 1.0e-3_DP
    point%time_increment = 100.0_DP / STEPS
    do i = 1, STEPS
      point%time = real(i, DP) * point%time_increment
      call update_material_point(material, .false., point, status)
      point%history_old = point%history
    end do
    q = (q0**(-3.5_DP) + 3 * G * 1.0e-14_DP * 3.5_DP * 100)**(-1 / 3.5_DP)
    call suite%near('creep: relaxation', sqrt(3.0_DP) * point%stress(4) / q, 1.0_DP, 1e-3_DP)
    do i = CREEP_TIME_HARDENING, CREEP_STRAIN_HARDENING
      material = creeping(i, -0.4_DP)
      call hold_stress(material, 200.0_DP, c)
      call suite%near('creep: primary, held stress', c / (1.0e-14_DP * 200**4.5_DP * 10**0.6_DP / 0.6_DP), 1.0_DP, &
        1e-6_DP)
    end do
  end subroutine check_creep_closed_forms


  !> Creep strain after ten units of time under a constant von Mises stress in shear.
  subroutine hold_stress(material, q, c)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: q
    real(DP), intent(out) :: c
    type(material_point_type) :: point
    integer :: i, k, status
    point = virgin()
    point%strain(4) = q / sqrt(3.0_DP) * 1.3_DP / 210000
    do i = 1, 10
      point%time = real(i, DP)
      do k = 1, 20
        call update_material_point(material, .false., point, status)
        point%strain(4) = point%strain(4) + 0.5_DP * (q / sqrt(3.0_DP) - point%stress(4)) / point%tangent(4, 4)
      end do
      point%history_old = point%history
    end do
    c = point%history_old(HISTORY_CEEQ)
  end subroutine hold_stress


  !> An initial stress is present without strain, and adds to the stress of the strain.
  subroutine check_initial_stress()
    type(material_type) :: material
    type(material_point_type) :: point
    real(DP) :: stress(6), R(3, 3), expected(6)
    integer :: law, status
    stress = [10.0_DP, -20.0_DP, 5.0_DP, 3.0_DP, -4.0_DP, 6.0_DP]
    material = elastic()
    do law = LAW_HENCKY, LAW_SAINT_VENANT
      material%law = law
      point = virgin()
      point%history_old(HISTORY_INELASTIC:HISTORY_INELASTIC + 5) = -elastic_strain_from_stress(material, 0.0_DP, IDENTITY, stress)
      call update_material_point(material, .false., point, status)
      call suite%near('initial stress: small', maxval(abs(point%stress - stress)), 0.0_DP, 1e-11_DP)
      call update_material_point(material, .true., point, status)
      call suite%near('initial stress: finite', maxval(abs(point%stress - stress)), 0.0_DP, 1e-9_DP)
      R = any_rotation()
      point%H = R - IDENTITY
      expected = pack_voigt(matmul(R, matmul(unpack_voigt(stress), transpose(R))))
      call update_material_point(material, .true., point, status)
      call suite%near('initial stress: turned', maxval(abs(point%stress - expected)), 0.0_DP, 1e-9_DP)
      point%H = any_gradient(0.2_DP)
      call check_tangent('initial stress', material, point, .true., 1e-7_DP)
    end do
  end subroutine check_initial_stress


  !> Closed forms at a finite stretch: deviator of neo-Hooke, 2 C10 (b - tr b/3)/J^(2/3); foam in one direction,
  !! tau = 2 mu/alpha (l^alpha - J^(-alpha beta)); Mooney-Rivlin in equibiaxial tension.
  subroutine check_simple_closed_forms()
    type(material_point_type) :: point
    real(DP) :: b(3), l, J, expected, stretch(3)
    integer :: status
    point = virgin()
    point%H(1, 1) = 0.5_DP
    point%H(2, 2) = -0.2_DP
    b = [2.25_DP, 0.64_DP, 1.0_DP]
    J = 1.2_DP
    call update_material_point(rubber(1), .true., point, status)
    call suite%near('neo-Hooke', point%stress(1), 2 * 0.5_DP * (b(1) - sum(b) / 3) / J**(2 / 3.0_DP) &
      + 2 / 0.1_DP * (J - 1) * J, 1e-13_DP)
    l = 1.4_DP
    point%H = 0
    point%H(3, 3) = 0.4_DP
    call update_material_point(rubber(9), .true., point, status)
    call suite%near('foam, nu = 0', point%stress(3), 2 * 0.7_DP / 4 * (l**4 - 1), 1e-13_DP)
    call suite%near('foam, nu = 0: nothing across', point%stress(1), 0.0_DP, 1e-15_DP)
    stretch = [1.3_DP, 1.3_DP, 1 / 1.69_DP]        ! J = 1
    point%H = 0
    point%H(1, 1) = 0.3_DP
    point%H(2, 2) = 0.3_DP
    point%H(3, 3) = stretch(3) - 1
    call update_material_point(rubber(2), .true., point, status)
    expected = 2 * (stretch(1)**2 - stretch(3)**2) * (0.5_DP + 0.2_DP * stretch(1)**2)
    call suite%near('Mooney-Rivlin, equibiaxial', point%stress(1) - point%stress(3), expected, 1e-13_DP)
  end subroutine check_simple_closed_forms

end program test_material_point
