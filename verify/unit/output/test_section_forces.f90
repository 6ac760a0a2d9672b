!> Unit test of amontons_section_forces: resultants of given stresses, turned elements, rotations of nodes.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_section_forces
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS
  use amontons_postprocess, only: integration_point_positions
  use amontons_section_forces, only: find_section_forces, find_node_rotations, N_SECTION_FORCES
  use amontons_state, only: fields_type
  use amontons_tensor, only: pack_voigt, rotation_matrix, unpack_voigt
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,2,0,0;3,2,1,0;4,0,1,0;5,1,0,0;6,2,.5,0;7,1,1,0;8,0,.5,0;' // &
    '11,0,5,0;12,1.5,5,0;13,3,5,0;*MATERIAL, NAME=M;*ELASTIC;100.,0.3;*ELEMENT, TYPE=S8R, ELSET=E;1,1,2,3,4,5,6,7,8;' // &
    '*SHELL SECTION, ELSET=E, MATERIAL=M;.1;*ELEMENT, TYPE=B32, ELSET=B;2,11,12,13;' // &
    '*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=RECT;.2,.3;0.,1.,0.;'
  character(*), parameter :: STEP_PART = '*STEP, NLGEOM;*STATIC;*END STEP;', LINEAR = '*STEP;*STATIC;*END STEP;'
  real(DP), parameter :: A = 0.06_DP, I1 = 0.2_DP * 0.3_DP**3 / 12, I2 = 0.3_DP * 0.2_DP**3 / 12   !< of the beam
  real(DP), parameter :: SHELL(9) = [0.3_DP, -0.2_DP, 0.1_DP, 0.05_DP, 0.025_DP, 0.0_DP, 0.04_DP / 12, 0.01_DP / 12, &
    -0.005_DP / 12]
  real(DP), parameter :: BEAM(9) = [5 * A, 3 * A, 2 * A, 0.0_DP, 0.0_DP, 0.0_DP, 70 * I1, -60 * I2, 4 * I2]
  type(suite_type) :: suite
  type(model_type) :: model
  type(fields_type) :: fields

  call expect_read('', model)
  call check_forces('at rest', [0.0_DP, 0.0_DP, 0.0_DP])
  call check_forces('turned', [0.6_DP, -0.3_DP, 0.0_DP])
  call check_forces('turned far', [-2.0_DP, 2.2_DP, 0.0_DP])
  call check_drill([0.2_DP, 0.9_DP, -0.5_DP])
  call check_drill([0.0_DP, 0.0_DP, 3.1415926_DP])
  call expect_read('', model, step=LINEAR)
  call check_small()
  call expect_message('', 'variable SX is not printed', is_note=.true., &
    step='*STEP;*STATIC;*EL PRINT, ELSET=E;SF,SM,SX;*NODE PRINT;U,UR;*END STEP;')
  call suite%finish()

contains

  include 'sample_deck.inc'

  !> Displacements of a rigid rotation about the origin, and given stresses turned with it.
  subroutine turn(w)
    real(DP), intent(in) :: w(3)
    real(DP), allocatable :: places(:, :)
    real(DP) :: R(3, 3), dR(3, 3, 3), s(6)
    integer :: p
    associate (mesh => model%mesh)
      call rotation_matrix(w, R, dR)
      fields%step = 1
      fields%u = matmul(R, mesh%coordinates) - mesh%coordinates
      allocate (places(3, mesh%n_points))
      call integration_point_positions(mesh, mesh%coordinates, places)
      if (allocated(fields%stress)) deallocate (fields%stress)
      allocate (fields%stress(6, mesh%n_points))
      do p = 1, mesh%n_points
        associate (y => places(2, p) - 5, z => places(3, p))
          s = [3 + 40 * z, -2 + 10 * z, 0.0_DP, 1 - 5 * z, 0.25_DP, 0.5_DP]   ! xx yy zz xy yz xz
          if (p >= mesh%point_first(2)) s = [5 + 60 * y + 70 * z, 0.0_DP, 0.0_DP, 2.0_DP, 0.0_DP, 3 + 4 * y]
        end associate
        fields%stress(:, p) = pack_voigt(matmul(R, matmul(unpack_voigt(s), transpose(R))))
      end do
    end associate
  end subroutine turn


  !> Both elements have the resultants of their stresses, and their nodes the rotation.
  subroutine check_forces(what, w)
    character(*), intent(in) :: what
    real(DP), intent(in) :: w(3)                   !< across the normal of the shell
    real(DP) :: forces(N_SECTION_FORCES, model%mesh%n_elements), rotation(3, model%mesh%n_nodes)
    call turn(w)
    call find_section_forces(model, fields, forces)
    call suite%near(what // ': shell', maxval(abs(forces(:, 1) - SHELL)), 0.0_DP, 1e-13_DP)
    call suite%near(what // ': beam', maxval(abs(forces(:, 2) - BEAM)), 0.0_DP, 1e-13_DP)
    call find_node_rotations(model, fields, rotation)
    call suite%near(what // ': rotation of all nodes', maxval(abs(rotation - spread(w, 2, model%mesh%n_nodes))), 0.0_DP, 1e-12_DP)
  end subroutine check_forces


  !> A cross-section turns about any axis.
  subroutine check_drill(w)
    real(DP), intent(in) :: w(3)
    real(DP) :: forces(N_SECTION_FORCES, model%mesh%n_elements), rotation(3, model%mesh%n_nodes)
    call turn(w)
    call find_section_forces(model, fields, forces)
    call suite%near('drilled: shell', maxval(abs(forces(:, 1) - SHELL)), 0.0_DP, 1e-13_DP)
    call suite%near('drilled: beam', maxval(abs(forces(:, 2) - BEAM)), 0.0_DP, 1e-13_DP)
    call find_node_rotations(model, fields, rotation)
    call suite%near('drilled: rotation', maxval(abs(rotation(:, 9:11) - spread(w, 2, 3))), 0.0_DP, 1e-9_DP)
  end subroutine check_drill


  !> Small displacements u = w x X have the rotation w, without its part along a fibre; the forces are those at rest.
  subroutine check_small()
    real(DP), parameter :: W(3) = [0.01_DP, 0.3_DP, -2.0_DP]
    real(DP) :: forces(N_SECTION_FORCES, model%mesh%n_elements), rotation(3, model%mesh%n_nodes)
    call turn([0.0_DP, 0.0_DP, 0.0_DP])
    associate (x => model%mesh%coordinates)
      fields%u(1, :) = W(2) * x(3, :) - W(3) * x(2, :)
      fields%u(2, :) = W(3) * x(1, :) - W(1) * x(3, :)
      fields%u(3, :) = W(1) * x(2, :) - W(2) * x(1, :)
    end associate
    call find_section_forces(model, fields, forces)
    call suite%near('small: shell', maxval(abs(forces(:, 1) - SHELL)), 0.0_DP, 1e-13_DP)
    call suite%near('small: beam', maxval(abs(forces(:, 2) - BEAM)), 0.0_DP, 1e-13_DP)
    call find_node_rotations(model, fields, rotation)
    call suite%near('small: fibres', maxval(abs(rotation(:, :8) - spread([W(1), W(2), 0.0_DP], 2, 8))), 0.0_DP, 1e-12_DP)
    call suite%near('small: cross-sections', maxval(abs(rotation(:, 9:11) - spread(W, 2, 3))), 0.0_DP, 1e-12_DP)
  end subroutine check_small

end program test_section_forces
